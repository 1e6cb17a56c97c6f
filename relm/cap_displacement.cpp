#include "relm/cap_displacement.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "failure/failure.h"
#include "settings/unit.h"

namespace abbe::relm {
namespace {

using recording::Recording;

constexpr double kMoving = 0.5;       // of the median speed of what moves
constexpr double kStandstill = 1e-6;  // m/s
constexpr Eigen::Index kSpan = 3;     // rows before and after over which a velocity is taken
// What the directions of motion must leave to tell the displacement from the offsets: the smallest
// scaled singular value of the equations.
constexpr double kTold = 0.05;

struct Readings {
  std::vector<char> axes;         // of the columns of `displacement`
  std::vector<std::size_t> rows;  // of the recording
  Eigen::MatrixXd displacement;   // rows x axes, m
  Eigen::Matrix3Xd commanded;     // m
  Eigen::VectorXd time, force, feed;
};

Eigen::VectorXd At(std::span<const double> column, const std::vector<std::size_t>& rows) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i)
    values[static_cast<Eigen::Index>(i)] = column[rows[i]];
  return values;
}

// What was seen less where it should be, along the axes that the reference has.
Readings Beside(const MeasuredPath& path, const Eigen::Matrix3Xd& seen,
                const Eigen::Matrix3Xd& expected) {
  Readings readings;
  for (int axis = 0; axis < 3; ++axis) {
    if (path.seen[static_cast<std::size_t>(axis)]) readings.axes.push_back("XYZ"[axis]);
  }
  readings.displacement.resize(path.poses(), static_cast<Eigen::Index>(readings.axes.size()));
  for (Eigen::Index k = 0; k < readings.displacement.cols(); ++k) {
    const int axis = readings.axes[static_cast<std::size_t>(k)] - 'X';
    readings.displacement.col(k) = (seen.row(axis) - expected.row(axis)).transpose();
  }
  return readings;
}

Readings FromGauges(const Recording& recording, const std::vector<std::size_t>& rows,
                    const std::vector<CapGauge>& gauges) {
  Readings readings;
  readings.displacement.resize(static_cast<Eigen::Index>(rows.size()),
                               static_cast<Eigen::Index>(gauges.size()));
  for (Eigen::Index k = 0; k < readings.displacement.cols(); ++k) {
    const CapGauge& gauge = gauges[static_cast<std::size_t>(k)];
    readings.axes.push_back(gauge.axis);
    readings.displacement.col(k) =
        At(recording.At(gauge.column), rows) * gauge.sign * settings::UnitOf(gauge.column).si;
  }
  if (!readings.displacement.allFinite()) {
    throw InputError(
        fmt::format("{}: a gauge reads no number in a row without a flag", recording.name));
  }
  return readings;
}

// Positions, times, force and feed of the rows without a flag; the reference where it is there.
MeasuredPath SteadyMotion(const Recording& recording) {
  if (HasReference(recording)) return ReferencePath(recording);
  Recording with = recording;  // the commanded position as its own reference: motion only
  for (const char axis : {'x', 'y', 'z'}) {
    if (const auto column = recording.Find(fmt::format("{}_mm", axis))) {
      with.columns.push_back({fmt::format("ref_{}_mm", axis), {column->begin(), column->end()}});
    }
  }
  return ReferencePath(with);
}

Eigen::Matrix3Xd Velocities(const Readings& readings) {
  const Eigen::Index n = readings.commanded.cols();
  Eigen::Matrix3Xd velocity = Eigen::Matrix3Xd::Zero(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index a = std::max<Eigen::Index>(0, i - kSpan);
    const Eigen::Index b = std::min<Eigen::Index>(n - 1, i + kSpan);
    const double dt = readings.time[b] - readings.time[a];
    if (dt > 0.0) velocity.col(i) = (readings.commanded.col(b) - readings.commanded.col(a)) / dt;
  }
  return velocity;
}

// Rows of one force and feed that move at their usual speed.
std::vector<Eigen::Index> Steady(const std::vector<Eigen::Index>& group,
                                 const Eigen::Matrix3Xd& velocity) {
  std::vector<double> speeds;
  for (const Eigen::Index i : group) {
    if (velocity.col(i).norm() > kStandstill) speeds.push_back(velocity.col(i).norm());
  }
  if (speeds.empty()) return {};
  const auto middle = speeds.begin() + static_cast<std::ptrdiff_t>(speeds.size() / 2);
  std::nth_element(speeds.begin(), middle, speeds.end());
  std::vector<Eigen::Index> steady;
  for (const Eigen::Index i : group) {
    if (velocity.col(i).norm() > kMoving * *middle) steady.push_back(i);
  }
  return steady;
}

// Strokes: rows in sequence, told apart by a pause or a turn of more than a right angle.
std::size_t Strokes(const std::vector<Eigen::Index>& rows, const Eigen::Matrix3Xd& velocity) {
  std::size_t strokes = 1;
  Eigen::Index begin = rows.front();
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const bool pause = rows[k] > rows[k - 1] + 1;
    if (pause || velocity.col(rows[k]).dot(velocity.col(begin)) < 0.0) {
      ++strokes;
      begin = rows[k];
    }
  }
  return strokes;
}

CapDisplacement Evaluate(const Readings& readings, const std::vector<Eigen::Index>& rows,
                         const Eigen::Matrix3Xd& velocity, const std::string& recording) {
  const Eigen::Index axes = readings.displacement.cols(),
                     n = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n * axes, axes + 1);
  Eigen::VectorXd d(n * axes);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index row = rows[static_cast<std::size_t>(i)];
    const Eigen::Vector3d direction = velocity.col(row).normalized();
    for (Eigen::Index k = 0; k < axes; ++k) {
      A(i * axes + k, k) = 1.0;
      A(i * axes + k, axes) = -direction[readings.axes[static_cast<std::size_t>(k)] - 'X'];
      d[i * axes + k] = readings.displacement(row, k);
    }
  }
  const Eigen::VectorXd scale = A.colwise().norm().cwiseMax(std::numeric_limits<double>::min());
  const Eigen::MatrixXd scaled = A * scale.cwiseInverse().asDiagonal();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(scaled.transpose() * scaled);
  if (svd.singularValues().minCoeff() < kTold) {
    throw InputError(
        fmt::format("{}: at {:.0f} mm/min the gauges see motion in one direction alone: the "
                    "displacement cannot "
                    "be told from their offsets; move to and fro",
                    recording, readings.feed[rows.front()] / settings::kMillimetre * 60.0));
  }
  const Eigen::VectorXd x = A.colPivHouseholderQr().solve(d);
  CapDisplacement result;
  result.displacement = x[axes];
  result.scatter = std::sqrt((d - A * x).squaredNorm() / static_cast<double>(d.size()));
  // Within a stroke readings share form and noise of low frequency: a stroke counts as one.
  const double strokes = static_cast<double>(Strokes(rows, velocity));
  result.u = result.scatter / std::sqrt(std::max(1.0, strokes));
  result.rows = rows.size();
  result.force = readings.force[rows.front()];
  result.feed = readings.feed[rows.front()];
  return result;
}

std::vector<CapDisplacement> Displacements(const Recording& recording, const MeasuredPath& motion,
                                           Readings readings) {
  readings.commanded = motion.commanded;
  readings.time = motion.time;
  readings.feed = motion.feed;
  const auto force = recording.Find("cap_force_n");
  readings.force =
      force ? At(*force, motion.rows)
            : Eigen::VectorXd::Constant(motion.poses(), std::numeric_limits<double>::quiet_NaN());
  const Eigen::Matrix3Xd velocity = Velocities(readings);
  std::map<std::pair<double, double>, std::vector<Eigen::Index>> groups;
  for (Eigen::Index i = 0; i < motion.poses(); ++i) {
    const double f = std::isfinite(readings.force[i]) ? readings.force[i] : 0.0;
    groups[{f, readings.feed[i]}].push_back(i);
  }
  std::vector<CapDisplacement> results;
  for (const auto& [key, rows] : groups) {
    const std::vector<Eigen::Index> steady = Steady(rows, velocity);
    if (steady.empty()) continue;
    results.push_back(Evaluate(readings, steady, velocity, recording.name));
  }
  if (results.empty()) {
    throw InputError(
        fmt::format("{}: the axes stand still in every row: the tool-cap test needs "
                    "motion",
                    recording.name));
  }
  return results;
}

}  // namespace

std::vector<CapDisplacement> EvaluateCap(const Recording& recording,
                                         const std::vector<CapGauge>& gauges) {
  if (gauges.empty() && !HasReference(recording)) {
    throw InputError(fmt::format(
        "{}: neither gauges nor reference positions: say which column reads the ball, for example "
        "--gauge X=probe_d_um",
        recording.name));
  }
  const MeasuredPath motion = SteadyMotion(recording);
  return Displacements(recording, motion,
                       gauges.empty() ? Beside(motion, motion.measured, motion.commanded)
                                      : FromGauges(recording, motion.rows, gauges));
}

std::vector<CapDisplacement> EvaluateCap(const Recording& recording, const MeasuredPath& ball) {
  if (!HasReference(recording)) {
    throw InputError(fmt::format(
        "{}: the linkage alone cannot tell the ball from the tool: record a reference beside it, "
        "or name a gauge on the cap, for example --gauge X=probe_d_um",
        recording.name));
  }
  const MeasuredPath tool = ReferencePath(recording);
  return Displacements(recording, tool, Beside(tool, ball.measured, tool.measured));
}

}  // namespace abbe::relm
