#include "probes/head_inversion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "failure/failure.h"

namespace abbe::probes {
namespace {

using Eigen::Vector3d;

// A layout whose triangle or span is smaller than this part of its size would magnify the noise of
// the probes beyond any use.
constexpr double kDegenerate = 1e-6;
// The exact inversions are for small motions; a normal that leans further is no reading of a head.
constexpr double kSmallestCosine = 0.5;

// Twice the signed area of the triangle A B C in the plane (u, s).
double TopArea(const HeadLayout<>& layout) {
  const auto& [a, b, c] = layout.top;
  const double area = (b.u - a.u) * (c.s - a.s) - (c.u - a.u) * (b.s - a.s);
  const double ab = std::hypot(b.u - a.u, b.s - a.s), ac = std::hypot(c.u - a.u, c.s - a.s),
               bc = std::hypot(c.u - b.u, c.s - b.s);
  const double longest = std::max({ab, ac, bc});
  if (!(std::abs(area) > kDegenerate * longest * longest)) {
    throw InputError(
        "probe head: the top probes A, B and C stand on one line, so roll and pitch cannot be "
        "separated; check [head.probe_a], [head.probe_b] and [head.probe_c] position_mm");
  }
  return area;
}

double SideSpan(const HeadLayout<>& layout) {
  const auto& [d, e] = layout.side;
  const double span = e.u - d.u;
  if (!(std::abs(span) > kDegenerate * std::hypot(d.u, d.n))) {
    throw InputError(
        "probe head: the side probes D and E stand at the same place along the sweep, so yaw "
        "cannot be seen; check [head.probe_d] and [head.probe_e] position_mm");
  }
  return span;
}

HeadLayout<> LayoutOf(const MeasuringLines<>& lines) {
  HeadLayout<> layout;
  for (std::size_t i = 0; i < kTopProbes; ++i) {
    layout.top[i] = {lines[i].point.x(), lines[i].point.y()};
  }
  for (std::size_t i = 0; i < kSideProbes; ++i) {
    layout.side[i] = {lines[kTopProbes + i].point.x(), lines[kTopProbes + i].point.z()};
  }
  return layout;
}

[[noreturn]] void RefuseReadings(const PerProbe<>& readings, double d) {
  throw NumericalError(fmt::format(
      "probe head: no small motion gives the readings {:.3f}, {:.3f}, {:.3f}, {:.3f}, {:.3f} um of "
      "probes A to E at d = {:.3f} mm; check the zero gaps and the layout in [head]",
      readings[0] * 1e6, readings[1] * 1e6, readings[2] * 1e6, readings[3] * 1e6, readings[4] * 1e6,
      d * 1e3));
}

}  // namespace

TopPlane::TopPlane(const HeadLayout<>& layout) {
  const double area = TopArea(layout);
  const auto& [a, b, c] = layout.top;
  ub_ = (c.s - a.s) / area;
  uc_ = -(b.s - a.s) / area;
  sb_ = -(c.u - a.u) / area;
  sc_ = (b.u - a.u) / area;
}

SimplifiedInversion::SimplifiedInversion(const HeadLayout<>& layout, MovingBody moving)
    : layout_(layout),
      top_(layout),
      sign_(moving == MovingBody::kTarget ? 1.0 : -1.0),
      travels_(moving == MovingBody::kTarget ? 1.0 : 0.0),
      inverse_span_(1 / SideSpan(layout)) {}

SmallAngleInversion::SmallAngleInversion(const HeadLayout<>& layout, MovingBody moving)
    : layout_(layout), moving_(moving), top_(layout), linear_(layout, moving) {}

HeadErrors<> SmallAngleInversion::operator()(const PerProbe<>& readings, double d,
                                             double exx) const {
  const HeadErrors<> e =
      moving_ == MovingBody::kHead ? linear_(readings, d, exx) : MovingTarget(readings, d, exx);
  if (!IsSmall(e)) RefuseReadings(readings, d);
  return e;
}

// Throws for the first station that is refused.
void SmallAngleInversion::RefuseFirst(const Readings& readings, const Eigen::VectorXd& d,
                                      const Errors& errors) const {
  for (Eigen::Index i = 0; i < readings.rows(); ++i) {
    const HeadErrors<> e{errors(i, 0), errors(i, 1), errors(i, 2), errors(i, 3), errors(i, 4), 0};
    if (IsSmall(e)) continue;
    PerProbe<> row;
    for (std::size_t k = 0; k < kProbes; ++k) row[k] = readings(i, k);
    RefuseReadings(row, d[i]);
  }
}

RigidInversion::RigidInversion(const MeasuringLines<>& lines, MovingBody moving)
    : lines_(lines), moving_(moving) {
  const HeadLayout<> layout = LayoutOf(lines);
  TopArea(layout);
  SideSpan(layout);
}

// Five points of the two surfaces, seen from the head: three give the normal of the top surface,
// the other two the normal of the side surface, which is square to it.
HeadErrors<> RigidInversion::operator()(const PerProbe<>& readings, double d, double exx) const {
  std::array<Vector3d, kProbes> at;
  for (std::size_t i = 0; i < kProbes; ++i) {
    at[i] = lines_[i].point + readings[i] * lines_[i].direction;
  }
  Vector3d top = (at[1] - at[0]).cross(at[2] - at[0]).normalized();
  if (top.z() < 0) top = -top;
  Vector3d side = top.cross(at[4] - at[3]).normalized();
  if (side.y() < 0) side = -side;
  if (!(top.z() > kSmallestCosine && side.y() > kSmallestCosine)) RefuseReadings(readings, d);

  Eigen::Matrix3d R_HT;
  R_HT << side.cross(top), side, top;
  const double at_top = top.dot(at[0]), at_side = side.dot(at[3]);
  if (moving_ == MovingBody::kHead) {
    const Vector3d angles = geometry::LogRotation<double>(R_HT.transpose());
    return {angles.x(), angles.y(), angles.z(), -at_side, -at_top, exx};
  }
  const Vector3d angles = geometry::LogRotation<double>(R_HT);
  const double top_rest = at_top - top.x() * (d + exx), side_rest = at_side - side.x() * (d + exx);
  const double determinant = top.z() * side.y() - top.y() * side.z();
  return {angles.x(),
          angles.y(),
          angles.z(),
          (top.z() * side_rest - side.z() * top_rest) / determinant,
          (side.y() * top_rest - top.y() * side_rest) / determinant,
          exx};
}

}  // namespace abbe::probes
