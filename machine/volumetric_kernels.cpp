// Highway compiles what stands between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each
// width of vectors and takes the widest that the processor has.
#include "machine/volumetric_kernels.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "machine/volumetric_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace abbe::machine::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;
static_assert(hn::MaxLanes(D()) <= MotionBlock::kBlock);

HWY_INLINE V All(double value) { return hn::Set(D(), value); }

struct Triple {
  V x, y, z;
};
HWY_INLINE Triple AllOf(const Eigen::Vector3d& v) { return {All(v.x()), All(v.y()), All(v.z())}; }
HWY_INLINE Triple operator+(const Triple& a, const Triple& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
HWY_INLINE Triple operator-(const Triple& a, const Triple& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
HWY_INLINE Triple operator*(V s, const Triple& a) { return {s * a.x, s * a.y, s * a.z}; }
HWY_INLINE V Dot(const Triple& a, const Triple& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
HWY_INLINE Triple Cross(const Triple& a, const Triple& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// By columns.
struct Matrix {
  Triple x, y, z;
};
HWY_INLINE Triple operator*(const Matrix& m, const Triple& v) {
  return v.x * m.x + v.y * m.y + v.z * m.z;
}
HWY_INLINE Matrix operator*(const Matrix& a, const Matrix& b) {
  return {a * b.x, a * b.y, a * b.z};
}
// a^T v and a^T.
HWY_INLINE Triple Back(const Matrix& a, const Triple& v) {
  return {Dot(a.x, v), Dot(a.y, v), Dot(a.z, v)};
}
HWY_INLINE Matrix Transposed(const Matrix& a) {
  return {{a.x.x, a.y.x, a.z.x}, {a.x.y, a.y.y, a.z.y}, {a.x.z, a.y.z, a.z.z}};
}

// The factors of a turn by a: sin a / a, (1 - cos a) / a^2 and (a - sin a) / a^3, by their series.
struct Series {
  V sine, versine, rest;
};
HWY_INLINE Series SeriesOf(V square) {
  const V s = square;
  return {All(1) - s * (All(1 / 6.) - s * (All(1 / 120.) - s * All(1 / 5040.))),
          All(1 / 2.) - s * (All(1 / 24.) - s * (All(1 / 720.) - s * All(1 / 40320.))),
          All(1 / 6.) - s * (All(1 / 120.) - s * (All(1 / 5040.) - s * All(1 / 362880.)))};
}

// exp(turn) v; the largest turn so far, squared.
HWY_INLINE Triple Turned(const Triple& turn, const Triple& v, V& largest) {
  const V square = Dot(turn, turn);
  largest = hn::Max(largest, square);
  const Series of = SeriesOf(square);
  const Triple across = Cross(turn, v);
  return v + of.sine * across + of.versine * Cross(turn, across);
}

// I + first [turn]x + second [turn]x^2: with `sine`, `versine` the rotation exp(turn), with
// `versine`, `rest` its left Jacobian.
HWY_INLINE Matrix TurnMatrix(const Triple& t, V first, V second) {
  const Triple u = second * t, w = first * t;
  const V diagonal = All(1) - Dot(u, t);
  return {{diagonal + u.x * t.x, u.x * t.y + w.z, u.x * t.z - w.y},
          {u.x * t.y - w.z, diagonal + u.y * t.y, u.y * t.z + w.x},
          {u.x * t.z + w.y, u.y * t.z - w.x, diagonal + u.z * t.z}};
}

// Some points of a block, as many as a vector has numbers.
struct Points {
  const PointBlock& block;
  std::size_t first;

  HWY_INLINE V Position(int axis) const { return hn::Load(D(), block.positions[axis] + first); }
  HWY_INLINE Triple Row(const double (*rows)[4]) const {
    Triple t;
    V fourth;
    hn::LoadInterleaved4(D(), rows[first], t.x, t.y, t.z, fourth);
    return t;
  }
  HWY_INLINE Triple Turn(int axis) const { return Row(block.motions[axis].turns); }
  HWY_INLINE Triple TurnSlopes(int axis) const { return Row(block.slopes[axis].turns); }
  HWY_INLINE Triple ShiftSlopes(int axis) const { return Row(block.slopes[axis].shifts); }

  // p of X_ab, volumetric_error.h.
  HWY_INLINE Triple Way(const Carriage& carriage) const {
    Triple shift = Row(block.motions[carriage.axis].shifts);
    const V sense = All(carriage.sense);
    V& along = carriage.axis == 0 ? shift.x : carriage.axis == 1 ? shift.y : shift.z;
    along = sense * along;
    return shift + (sense * Position(carriage.axis)) * AllOf(carriage.line);
  }
};

// What a perfect machine would have is subtracted.
HWY_INLINE Triple ErrorOf(const Triple& p_WQ, const Triple& p_TQ, const Points& points,
                          const Carriages& carriages) {
  const auto& t = carriages.tool_senses;
  return p_WQ - (p_TQ + Triple{All(t[0]) * points.Position(0), All(t[1]) * points.Position(1),
                               All(t[2]) * points.Position(2)});
}

// The tool point, carried from carriage to carriage to the bed.
HWY_INLINE Triple OnBed(const Triple& p_TQ, const Points& points, const Carriages& carriages,
                        V& largest) {
  Triple p = p_TQ;
  for (int k = carriages.tool_count - 1; k >= 0; --k) {
    const Carriage& a = carriages.tool[k];
    p = Turned(points.Turn(a.axis), p, largest) + points.Way(a);
  }
  return p;
}

// The equations of volumetric_error.h: the tool point is carried from carriage to carriage to the
// bed, then from the bed to the workpiece.
double Errors(const Carriages& carriages, const Eigen::Vector3d& tool, const PointBlock& block,
              int count, double* errors) {
  const std::size_t lanes = hn::Lanes(D()), n = count;
  const Triple p_TQ = AllOf(tool);
  V largest = hn::Zero(D());
  double rest[3 * hn::MaxLanes(D())];
  for (std::size_t i = 0; i < n; i += lanes) {
    const Points points{block, i};
    Triple p = OnBed(p_TQ, points, carriages, largest);
    for (int k = 0; k < carriages.work_count; ++k) {
      const Carriage& a = carriages.work[k];
      p = Turned(All(-1) * points.Turn(a.axis), p - points.Way(a), largest);
    }
    const Triple e = ErrorOf(p, p_TQ, points, carriages);
    const bool whole = i + lanes <= n;
    hn::StoreInterleaved3(e.x, e.y, e.z, D(), whole ? errors + 3 * i : rest);
    if (!whole) std::copy_n(rest, 3 * (n - i), errors + 3 * i);
  }
  return hn::GetLane(hn::MaxOfLanes(D(), largest));
}

// The rows of some points: the numbers of a row are those of the points.
struct Rows {
  HWY_ALIGN double at[kRows][hn::MaxLanes(D())] = {};
};

HWY_INLINE void Put(const Triple& column, int row, Rows& rows) {
  hn::Store(column.x, D(), rows.at[row]);
  hn::Store(column.y, D(), rows.at[row + 1]);
  hn::Store(column.z, D(), rows.at[row + 2]);
}

// Point after point instead of row after row, four rows at a time.
HWY_INLINE void Transpose(const Rows& rows, std::size_t points, double* columns) {
  constexpr std::size_t kQuads = kRows / 4;
  static_assert(kRows == 4 * kQuads);
  const D d;
  HWY_ALIGN double quads[kQuads][4 * hn::MaxLanes(d)];
  for (std::size_t q = 0; q < kQuads; ++q) {
    const auto* const row = rows.at + 4 * q;
    hn::StoreInterleaved4(hn::Load(d, row[0]), hn::Load(d, row[1]), hn::Load(d, row[2]),
                          hn::Load(d, row[3]), d, quads[q]);
  }
  for (std::size_t i = 0; i < points; ++i) {
    for (std::size_t q = 0; q < kQuads; ++q) {
      std::copy_n(quads[q] + 4 * i, 4, columns + kRows * i + 4 * q);
    }
  }
}

// The equations of volumetric_jacobian.h for the carriages from the bed to one end of the chain. R_Wa and p_aQ are those of the bed before, those of the last carriage after; side is +1 on
// the tool side, -1 on the workpiece side.
HWY_INLINE void Walk(const std::array<Carriage, kAxes>& carriages, int count, double side,
                     const Points& points, Matrix& R_Wa, Triple& p_aQ, Matrix& by_squareness,
                     Rows& rows) {
  for (int k = 0; k < count; ++k) {
    const Carriage& a = carriages[k];
    const V sense = All(a.sense);
    const Triple turn = points.Turn(a.axis);
    const Series of = SeriesOf(Dot(turn, turn));
    const Matrix J = TurnMatrix(turn, of.versine, of.rest);
    const Triple arm = p_aQ - points.Way(a);
    const V s = All(side);
    const Matrix R = {s * R_Wa.x, s * R_Wa.y, s * R_Wa.z};

    Matrix by_shift = R;
    Triple& along = a.axis == 0 ? by_shift.x : a.axis == 1 ? by_shift.y : by_shift.z;
    along = sense * along;
    const Matrix by_turn = {R * Cross(J.x, arm), R * Cross(J.y, arm), R * Cross(J.z, arm)};
    const int first = kByMotions + 18 * a.axis;
    Put(by_shift.x, first, rows);
    Put(by_shift.y, first + 3, rows);
    Put(by_shift.z, first + 6, rows);
    Put(by_turn.x, first + 9, rows);
    Put(by_turn.y, first + 12, rows);
    Put(by_turn.z, first + 15, rows);

    const V moved = sense * points.Position(a.axis);
    if (a.axis == 1) {
      by_squareness.z = by_squareness.z + moved * (R * AllOf(a.J_line_squareness.col(2)));
    } else if (a.axis == 2) {
      by_squareness.x = by_squareness.x + moved * (R * AllOf(a.J_line_squareness.col(0)));
      by_squareness.y = by_squareness.y + moved * (R * AllOf(a.J_line_squareness.col(1)));
    }
    const Eigen::Vector3d nominal = side * Eigen::Vector3d::Unit(a.axis);
    Put(sense * (R * AllOf(a.line) - AllOf(nominal)) + by_shift * points.ShiftSlopes(a.axis) +
            by_turn * points.TurnSlopes(a.axis),
        kByPosition + 3 * a.axis, rows);

    const Matrix R_ab = TurnMatrix(turn, of.sine, of.versine);
    p_aQ = Back(R_ab, arm);
    R_Wa = R_Wa * R_ab;
  }
}

double Derivatives(const Carriages& carriages, const Eigen::Vector3d& tool, const PointBlock& block,
                   int count, double* out) {
  V largest = hn::Zero(D());
  Rows rows;  // zero for axes that the chain lacks
  const std::size_t lanes = hn::Lanes(D()), n = count;
  const V zero = hn::Zero(D()), one = All(1);
  const Triple p_TQ = AllOf(tool), none = {zero, zero, zero};
  const Matrix identity = {{one, zero, zero}, {zero, one, zero}, {zero, zero, one}};
  for (std::size_t i = 0; i < n; i += lanes) {
    const Points points{block, i};
    const Triple p_MQ = OnBed(p_TQ, points, carriages, largest);
    Matrix R_MW = identity;
    for (int k = 0; k < carriages.work_count; ++k) {
      const Triple turn = points.Turn(carriages.work[k].axis);
      const V square = Dot(turn, turn);
      largest = hn::Max(largest, square);
      const Series of = SeriesOf(square);
      R_MW = R_MW * TurnMatrix(turn, of.sine, of.versine);
    }
    Matrix by_squareness = {none, none, none};
    Matrix R_Ww = Transposed(R_MW), R_Wt = R_Ww;
    Triple p_WQ = p_MQ, p_tQ = p_MQ;
    Walk(carriages.work, carriages.work_count, -1, points, R_Ww, p_WQ, by_squareness, rows);
    Walk(carriages.tool, carriages.tool_count, 1, points, R_Wt, p_tQ, by_squareness, rows);
    Put(ErrorOf(p_WQ, p_TQ, points, carriages), kOfError, rows);
    Put(by_squareness.x, kBySquareness, rows);
    Put(by_squareness.y, kBySquareness + 3, rows);
    Put(by_squareness.z, kBySquareness + 6, rows);
    Put(R_Wt.x - identity.x, kByTool, rows);
    Put(R_Wt.y - identity.y, kByTool + 3, rows);
    Put(R_Wt.z - identity.z, kByTool + 6, rows);
    Transpose(rows, std::min(lanes, n - i), out + kRows * i);
  }
  return hn::GetLane(hn::MaxOfLanes(D(), largest));
}

// The numbers of one place are side by side: vectors of up to four.
void Pieces(std::span<const PlaceInPiece> places, int degree, MotionBlock& values,
            MotionBlock* slopes) {
  const hn::CappedTag<double, 4> d;
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto [c, t, per_width] = places[i];
    const auto at = hn::Set(d, t);
    for (std::size_t j = 0; j < 4; j += lanes) {
      auto shift = hn::Load(d, c[degree].shift + j), turn = hn::Load(d, c[degree].turn + j);
      auto shift_slope = hn::Zero(d), turn_slope = hn::Zero(d);
      for (int k = degree - 1; k >= 0; --k) {
        if (slopes != nullptr) {
          shift_slope = shift + at * shift_slope;
          turn_slope = turn + at * turn_slope;
        }
        shift = hn::Load(d, c[k].shift + j) + at * shift;
        turn = hn::Load(d, c[k].turn + j) + at * turn;
      }
      hn::Store(shift, d, values.shifts[i] + j);
      hn::Store(turn, d, values.turns[i] + j);
      if (slopes == nullptr) continue;
      hn::Store(hn::Set(d, per_width) * shift_slope, d, slopes->shifts[i] + j);
      hn::Store(hn::Set(d, per_width) * turn_slope, d, slopes->turns[i] + j);
    }
  }
}

}  // namespace abbe::machine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace abbe::machine {

HWY_EXPORT(Pieces);
HWY_EXPORT(Errors);
HWY_EXPORT(Derivatives);

void EvaluatePieces(std::span<const PlaceInPiece> places, int degree, MotionBlock& values,
                    MotionBlock* slopes) {
  HWY_DYNAMIC_DISPATCH(Pieces)(places, degree, values, slopes);
}

double BlockErrors(const Carriages& carriages, const Eigen::Vector3d& p_TQ,
                   const PointBlock& points, int count, double* errors) {
  return HWY_DYNAMIC_DISPATCH(Errors)(carriages, p_TQ, points, count, errors);
}

double BlockDerivatives(const Carriages& carriages, const Eigen::Vector3d& p_TQ,
                        const PointBlock& points, int count, double* rows) {
  return HWY_DYNAMIC_DISPATCH(Derivatives)(carriages, p_TQ, points, count, rows);
}

}  // namespace abbe::machine
#endif  // HWY_ONCE
