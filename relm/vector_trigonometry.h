// Sine, cosine and arc tangent of the numbers of a vector, for kernels that are compiled once for
// each width of the processor's vectors (Highway) and include this each time.
//
// The reductions and polynomials are the same on all widths; widths with a fused multiply-add round
// less often. Each result is within 2.5 units in the last place of the true value.
//
// Units: rad.
// Failure: none; what is outside the validity has no meaningful result.
// Source: the polynomials and the parts of pi/2 of fdlibm (Sun Microsystems, 1993: k_sin.c,
// k_cos.c, s_atan.c, e_rem_pio2.c).
// Validity: angles up to kLargestAngle in size; coordinates finite, not both zero, their sum and
// the quotient of the smaller by the larger without overflow.
#if defined(ABBE_RELM_VECTOR_TRIGONOMETRY_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_RELM_VECTOR_TRIGONOMETRY_H_
#undef ABBE_RELM_VECTOR_TRIGONOMETRY_H_
#else
#define ABBE_RELM_VECTOR_TRIGONOMETRY_H_
#endif

#include <hwy/highway.h>

#include <numbers>

HWY_BEFORE_NAMESPACE();
namespace abbe::relm::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// c0 + x (c1 + x (c2 + ...)).
template <typename V>
HWY_INLINE V Polynomial(V, double c) {
  return hn::Set(hn::DFromV<V>(), c);
}
template <typename V, typename... More>
HWY_INLINE V Polynomial(V x, double c0, More... more) {
  return hn::MulAdd(Polynomial(x, more...), x, hn::Set(hn::DFromV<V>(), c0));
}

template <typename V>
struct SineAndCosine {
  V sine, cosine;
};

// Its multiple of pi/2 has 20 bits.
inline constexpr double kLargestAngle = 1.6e6;

// The angle less the nearest multiple of pi/2, whose number modulo 4 says which of the two is the
// sine and which signs they have. A number plus 1.5 * 2^52 is rounded to an integer that stands in
// its last bits. Each part of pi/2 has 33 bits: its product with the number is exact.
template <typename V>
HWY_INLINE SineAndCosine<V> SineAndCosineOf(V angle) {
  const hn::DFromV<V> d;
  const hn::RebindToUnsigned<decltype(d)> bits;
  const V shift = hn::Set(d, 0x1.8p52);
  const V shifted = hn::MulAdd(angle, hn::Set(d, 2 / std::numbers::pi), shift);
  const V quarters = hn::Sub(shifted, shift);
  V x = hn::NegMulAdd(quarters, hn::Set(d, 1.57079632673412561417e+00), angle);
  x = hn::NegMulAdd(quarters, hn::Set(d, 6.07710050630396597660e-11), x);
  x = hn::NegMulAdd(quarters, hn::Set(d, 2.02226624879595063154e-21), x);

  const V z = hn::Mul(x, x);
  const V sine = hn::MulAdd(hn::Mul(z, x),
                            Polynomial(z, -1.66666666666666324348e-01, 8.33333333332248946124e-03,
                                       -1.98412698298579493134e-04, 2.75573137070700676789e-06,
                                       -2.50507602534068634195e-08, 1.58969099521155010221e-10),
                            x);
  const V cosine = Polynomial(z, 1.0, -0.5, 4.16666666666666019037e-02, -1.38888888888741095749e-03,
                              2.48015872894767294178e-05, -2.75573143513906633035e-07,
                              2.08757232129817482790e-09, -1.13596475577881948265e-11);

  const auto number = hn::BitCast(bits, shifted);
  const auto one = hn::Set(bits, 1), two = hn::Set(bits, 2);
  const auto swapped =
      hn::MaskFromVec(hn::BitCast(d, hn::Sub(hn::Zero(bits), hn::And(number, one))));
  const V minus_sine = hn::BitCast(d, hn::ShiftLeft<62>(hn::And(number, two)));
  const V minus_cosine = hn::BitCast(d, hn::ShiftLeft<62>(hn::And(hn::Add(number, one), two)));
  return {hn::Xor(hn::IfThenElse(swapped, cosine, sine), minus_sine),
          hn::Xor(hn::IfThenElse(swapped, sine, cosine), minus_cosine)};
}

// The angle of the point (x, y) from the x axis, in [-pi, pi]. t is the tangent of the angle to the
// nearer axis; beyond pi/8 the angle is pi/4 + atan((t - 1) / (t + 1)).
template <typename V>
HWY_INLINE V ArcTangentOf(V y, V x) {
  const hn::DFromV<V> d;
  const V zero = hn::Zero(d);
  const V long_x = hn::Abs(x), long_y = hn::Abs(y);
  const V low = hn::Min(long_x, long_y), high = hn::Max(long_x, long_y);
  const auto beyond = hn::Gt(low, hn::Mul(high, hn::Set(d, std::numbers::sqrt2 - 1)));
  const V t = hn::Div(hn::IfThenElse(beyond, hn::Sub(low, high), low),
                      hn::Add(high, hn::IfThenElseZero(beyond, low)));
  const V z = hn::Mul(t, t);
  const V less = hn::Mul(z, Polynomial(z, 3.33333333333329318027e-01, -1.99999999998764832476e-01,
                                       1.42857142725034663711e-01, -1.11111104054623557880e-01,
                                       9.09088713343650656196e-02, -7.69187620504482999495e-02,
                                       6.66107313738753120669e-02, -5.83357013379057348645e-02,
                                       4.97687799461593236017e-02, -3.65315727442169155270e-02,
                                       1.62858201153657823623e-02));
  V angle = hn::NegMulAdd(t, less, t);
  angle = hn::Add(angle, hn::IfThenElseZero(beyond, hn::Set(d, std::numbers::pi / 4)));
  angle = hn::IfThenElse(hn::Gt(long_y, long_x), hn::Sub(hn::Set(d, std::numbers::pi / 2), angle),
                         angle);
  angle = hn::IfThenElse(hn::Lt(x, zero), hn::Sub(hn::Set(d, std::numbers::pi), angle), angle);
  return hn::CopySignToAbs(angle, y);
}

}  // namespace abbe::relm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
