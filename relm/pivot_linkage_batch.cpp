// The batch functions of the closed form: the same equations on as many poses at once as a vector
// has numbers. Highway compiles what stands between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE
// once for each width and takes the widest that the processor has.
#include <algorithm>
#include <cmath>

#include "relm/pivot_linkage.h"

namespace abbe::relm {

// Overwrite the tips of angles beyond kLargestAngle, and the angles of tips whose `reached` is 0.
void LargeTips(const PivotLinkage& linkage, const double* angles, std::size_t count, double* tips);
void SingularAngles(const PivotLinkage& linkage, const Branch& branch, const double* tips,
                    const double* reached, std::size_t count, double* angles, Reach* reach);

}  // namespace abbe::relm

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "relm/pivot_linkage_batch.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "relm/vector_trigonometry.h"

HWY_BEFORE_NAMESPACE();
namespace abbe::relm::HWY_NAMESPACE {

using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;

struct Triple {
  V x, y, z;
};

// The equations of pivot_linkage.h.
HWY_INLINE Triple TipOf(const Triple& q, V L1, V L2) {
  const auto [s1, c1] = SineAndCosineOf(q.x);
  const auto [s2, c2] = SineAndCosineOf(q.y);
  const auto [s3, c3] = SineAndCosineOf(q.z);
  const V a = L1 + L2 * s3, b = L2 * c3;
  const V r = b * s2 + a * c2;
  return {c1 * r, s1 * r, b * c2 - a * s2};
}

struct Inverse {
  Triple q;
  hn::Mask<D> reached;
};

// Those of docs/theory-linkage.md. over: -1 for a branch that reaches over; elbow: the sign of
// cos q3. `reached` as in PivotLinkage::ReachOf.
HWY_INLINE Inverse InverseOf(const Triple& p, V L1, V L2, V over, V elbow) {
  const D d;
  const V one = hn::Set(d, 1.0), limit = hn::Set(d, PivotLinkage::kSingular);
  const V per_area = one / (L1 * L2 + L1 * L2), squares = L1 * L1 + L2 * L2;
  const V square = p.x * p.x + p.y * p.y;
  const V r = over * hn::Sqrt(square);
  const V sine = (square + p.z * p.z - squares) * per_area;
  const V cosine_square = (one - sine) * (one + sine);
  const V cosine = elbow * hn::Sqrt(cosine_square);
  const V a = L1 + L2 * sine, b = L2 * cosine;
  const V near_axis = limit * (L1 + L2);
  return {{ArcTangentOf(over * p.y, over * p.x), ArcTangentOf(b * r - a * p.z, a * r + b * p.z),
           ArcTangentOf(sine, cosine)},
          hn::And(hn::Ge(cosine_square, limit * limit), hn::Gt(square, near_axis * near_axis))};
}

HWY_INLINE Triple LoadColumns(const double* columns) {
  Triple t;
  hn::LoadInterleaved3(D(), columns, t.x, t.y, t.z);
  return t;
}

HWY_INLINE void StoreColumns(const Triple& t, double* columns) {
  hn::StoreInterleaved3(t.x, t.y, t.z, D(), columns);
}

constexpr std::size_t kMostLanes = hn::MaxLanes(D());

// One vector of poses. Where an angle is too large for the vector's reduction, or no number, the
// single pose's function is called.
HWY_INLINE void SomeTips(const PivotLinkage& linkage, V L1, V L2, const double* angles,
                         double* tips) {
  const D d;
  const Triple q = LoadColumns(angles);
  const V largest = hn::Set(d, kLargestAngle);
  const auto inside = hn::And(hn::And(hn::Le(hn::Abs(q.x), largest), hn::Le(hn::Abs(q.y), largest)),
                              hn::Le(hn::Abs(q.z), largest));
  StoreColumns(TipOf(q, L1, L2), tips);
  if (HWY_LIKELY(hn::AllTrue(d, inside))) return;
  double kept[3 * kMostLanes];
  StoreColumns(q, kept);
  LargeTips(linkage, kept, hn::Lanes(d), tips);
}

// The same back. What the vector does not reach is left to the single pose's functions.
HWY_INLINE void SomeAngles(const PivotLinkage& linkage, const Branch& branch, V L1, V L2, V over,
                           V elbow, const double* tips, double* angles, Reach* reach) {
  const D d;
  const Triple p = LoadColumns(tips);
  const Inverse inverse = InverseOf(p, L1, L2, over, elbow);
  StoreColumns(inverse.q, angles);
  std::fill_n(reach, hn::Lanes(d), Reach::kReached);
  if (HWY_LIKELY(hn::AllTrue(d, inverse.reached))) return;
  double kept[3 * kMostLanes], reached[kMostLanes];
  StoreColumns(p, kept);
  hn::StoreU(hn::IfThenElseZero(inverse.reached, hn::Set(d, 1.0)), d, reached);
  SingularAngles(linkage, branch, kept, reached, hn::Lanes(d), angles, reach);
}

void AllTips(const PivotLinkage& linkage, const double* angles, std::size_t count, double* tips) {
  const D d;
  const V L1 = hn::Set(d, linkage.link_1()), L2 = hn::Set(d, linkage.link_2());
  const std::size_t lanes = hn::Lanes(d), rest = count % lanes, whole = count - rest;
  for (std::size_t i = 0; i < whole; i += lanes) {
    SomeTips(linkage, L1, L2, angles + 3 * i, tips + 3 * i);
  }
  if (rest == 0) return;
  double from[3 * kMostLanes] = {}, to[3 * kMostLanes];
  std::copy_n(angles + 3 * whole, 3 * rest, from);
  SomeTips(linkage, L1, L2, from, to);
  std::copy_n(to, 3 * rest, tips + 3 * whole);
}

void AllAngles(const PivotLinkage& linkage, const Branch& branch, const double* tips,
               std::size_t count, double* angles, Reach* reach) {
  const D d;
  const V L1 = hn::Set(d, linkage.link_1()), L2 = hn::Set(d, linkage.link_2());
  const V over = hn::Set(d, branch.reach_over ? -1.0 : 1.0);
  const V elbow = branch.elbow == Elbow::kUp ? hn::Neg(over) : over;
  const std::size_t lanes = hn::Lanes(d), rest = count % lanes, whole = count - rest;
  for (std::size_t i = 0; i < whole; i += lanes) {
    SomeAngles(linkage, branch, L1, L2, over, elbow, tips + 3 * i, angles + 3 * i, reach + i);
  }
  if (rest == 0) return;
  double from[3 * kMostLanes] = {}, to[3 * kMostLanes];
  Reach why[kMostLanes];
  std::copy_n(tips + 3 * whole, 3 * rest, from);
  SomeAngles(linkage, branch, L1, L2, over, elbow, from, to, why);
  std::copy_n(to, 3 * rest, angles + 3 * whole);
  std::copy_n(why, rest, reach + whole);
}

}  // namespace abbe::relm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace abbe::relm {

HWY_EXPORT(AllTips);
HWY_EXPORT(AllAngles);

void LargeTips(const PivotLinkage& linkage, const double* angles, std::size_t count, double* tips) {
  for (std::size_t i = 0; i < 3 * count; i += 3) {
    const Eigen::Vector3d q(angles[i], angles[i + 1], angles[i + 2]);
    if ((q.array().abs() <= HWY_NAMESPACE::kLargestAngle).all()) continue;
    Eigen::Vector3d::Map(tips + i) = linkage.Tip(q);
  }
}

void SingularAngles(const PivotLinkage& linkage, const Branch& branch, const double* tips,
                    const double* reached, std::size_t count, double* angles, Reach* reach) {
  for (std::size_t i = 0; i < count; ++i) {
    if (reached[i] != 0) continue;
    const Eigen::Vector3d p = Eigen::Vector3d::Map(tips + 3 * i);
    const auto q = linkage.FindAngles(p, branch);
    Eigen::Vector3d::Map(angles + 3 * i) = q.value_or(Eigen::Vector3d::Zero());
    reach[i] = q ? Reach::kReached : linkage.ReachOf(p);
  }
}

void PivotLinkage::Tips(const Poses& angles, Eigen::Matrix3Xd& tips) const {
  tips.resize(3, angles.cols());
  HWY_DYNAMIC_DISPATCH(AllTips)(*this, angles.data(), angles.cols(), tips.data());
}

Eigen::Index PivotLinkage::AnglesOf(const Poses& tips, const Branch& branch,
                                    Eigen::Matrix3Xd& angles, std::vector<Reach>& reach) const {
  angles.resize(3, tips.cols());
  reach.resize(tips.cols());
  HWY_DYNAMIC_DISPATCH(AllAngles)
  (*this, branch, tips.data(), tips.cols(), angles.data(), reach.data());
  return std::count(reach.begin(), reach.end(), Reach::kReached);
}

}  // namespace abbe::relm
#endif  // HWY_ONCE
