#include "paths/cap_displacement.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "failure/failure.h"
#include "settings/unit.h"

namespace abbe::paths {
namespace {

using recording::Recording;

constexpr double kMoving = 0.5;       // of the median speed of moving rows
constexpr double kStandstill = 1e-6;  // m/s
constexpr Eigen::Index kSpan = 3;     // rows before and after over which a velocity is taken
constexpr double kStraight = 0.9;     // cosine of the turn that ends a stroke
constexpr double kParallel = 0.99;    // cosine
constexpr double kSameWay = 0.1;      // of the length: how far apart strokes of one way may lie
constexpr double kSeen = 0.05;        // least squared part of a direction along measured axes
constexpr double kOneWay = 0.999;     // mean sense of a line passed in one direction

struct Readings {
  std::vector<char> axes;         // of the columns of `displacement`
  std::vector<std::size_t> rows;  // of the recording
  Eigen::MatrixXd displacement;   // rows x axes, m
  Eigen::Matrix3Xd commanded;     // m
  Eigen::VectorXd time, force, feed;
};

Eigen::VectorXd At(std::span<const double> column, const std::vector<std::size_t>& rows) {
  Eigen::VectorXd values(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) values[i] = column[rows[i]];
  return values;
}

// `seen` minus `expected`, along the axes that were measured.
Readings Beside(const MeasuredPath& path, const Eigen::Matrix3Xd& seen,
                const Eigen::Matrix3Xd& expected) {
  Readings readings;
  for (int axis = 0; axis < 3; ++axis) {
    if (path.seen[axis]) readings.axes.push_back("XYZ"[axis]);
  }
  readings.displacement.resize(path.poses(), readings.axes.size());
  for (Eigen::Index k = 0; k < readings.displacement.cols(); ++k) {
    const int axis = readings.axes[k] - 'X';
    readings.displacement.col(k) = (seen.row(axis) - expected.row(axis)).transpose();
  }
  return readings;
}

Readings FromGauges(const Recording& recording, const std::vector<std::size_t>& rows,
                    const std::vector<CapGauge>& gauges) {
  Readings readings;
  readings.displacement.resize(rows.size(), gauges.size());
  for (Eigen::Index k = 0; k < readings.displacement.cols(); ++k) {
    const CapGauge& gauge = gauges[k];
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

// The rows without a flag; `measured` is the commanded path where there is no reference.
MeasuredPath SteadyMotion(const Recording& recording) {
  if (HasReference(recording)) return ReferencePath(recording);
  Recording with = recording;  // the commanded position as its own reference
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
  const auto middle = speeds.begin() + (speeds.size() / 2);
  std::nth_element(speeds.begin(), middle, speeds.end());
  std::vector<Eigen::Index> steady;
  for (const Eigen::Index i : group) {
    if (velocity.col(i).norm() > kMoving * *middle) steady.push_back(i);
  }
  return steady;
}

// Rows in sequence and in one direction.
struct Stroke {
  std::vector<Eigen::Index> rows;
  Eigen::Vector3d direction;         // of its first row
  Eigen::Vector3d middle, from, to;  // commanded, m
  double along = 0.0;                // mean reading along the line
};

// Splits rows at pauses and reversals.
std::vector<Stroke> StrokesOf(const std::vector<Eigen::Index>& rows,
                              const Eigen::Matrix3Xd& velocity, const Eigen::Matrix3Xd& commanded) {
  std::vector<Stroke> strokes;
  for (const Eigen::Index row : rows) {
    const Eigen::Vector3d direction = velocity.col(row).normalized();
    const bool goes_on = !strokes.empty() && row == strokes.back().rows.back() + 1 &&
                         direction.dot(strokes.back().direction) > kStraight;
    if (!goes_on)
      strokes.push_back({{}, direction, {0, 0, 0}, commanded.col(row), commanded.col(row), 0.0});
    Stroke& stroke = strokes.back();
    stroke.rows.push_back(row);
    stroke.to = commanded.col(row);
    stroke.middle += commanded.col(row);
  }
  // What short strokes are: the rows of a reversal.
  std::erase_if(strokes, [](const Stroke& stroke) { return std::ssize(stroke.rows) <= 2 * kSpan; });
  for (Stroke& stroke : strokes) {
    stroke.middle /= stroke.rows.size();
    stroke.direction = (stroke.to - stroke.from).normalized();
  }
  return strokes;
}

// Strokes over one way, and their mean reading along it.
struct Line {
  std::vector<Stroke*> strokes;
  Eigen::VectorXd seen;  // the direction, along the axes that were measured
  double weight = 0.0;   // square of its length
  double sense = 0.0;    // mean over its strokes
  double along = 0.0;

  double SenseOf(const Stroke& stroke) const {
    return stroke.direction.dot(strokes.front()->direction) > 0.0 ? 1.0 : -1.0;
  }
};

bool ShareALine(const Stroke& one, const Stroke& other, bool same_way) {
  if (std::abs(one.direction.dot(other.direction)) < kParallel) return false;
  const double apart = (one.middle - other.middle).norm();
  return !same_way || apart < kSameWay * (one.to - one.from).norm();
}

std::vector<Line> LinesOf(std::vector<Stroke>& strokes, const Readings& readings, bool same_way) {
  std::vector<Line> lines;
  for (Stroke& stroke : strokes) {
    const auto line = std::ranges::find_if(lines, [&](const Line& each) {
      return ShareALine(*each.strokes.front(), stroke, same_way);
    });
    (line == lines.end() ? lines.emplace_back() : *line).strokes.push_back(&stroke);
  }
  for (Line& line : lines) {
    line.seen.resize(readings.displacement.cols());
    for (Eigen::Index k = 0; k < line.seen.size(); ++k) {
      line.seen[k] = line.strokes.front()->direction[readings.axes[k] - 'X'];
    }
    line.weight = line.seen.squaredNorm();
    if (line.weight < kSeen) continue;
    const double count = line.strokes.size();
    for (Stroke* stroke : line.strokes) {
      stroke->along =
          (readings.displacement(stroke->rows, Eigen::all) * line.seen).mean() / line.weight;
      line.along += stroke->along / count;
      line.sense += line.SenseOf(*stroke) / count;
    }
  }
  // A line passed in one direction does not determine e.
  std::erase_if(lines, [](const Line& line) {
    return line.weight < kSeen || std::abs(line.sense) > kOneWay;
  });
  return lines;
}

double Displacement(const std::vector<Line>& lines) {
  double product = 0.0, square = 0.0;
  for (const Line& line : lines) {
    for (const Stroke* stroke : line.strokes) {
      const double sense = line.SenseOf(*stroke) - line.sense;
      product -= line.weight * sense * (stroke->along - line.along);
      square += line.weight * sense * sense;
    }
  }
  return product / square;
}

// u, its degrees of freedom, the scatter of the rows.
void AddScatter(const std::vector<Line>& lines, const Readings& readings, CapDisplacement& result) {
  double left = 0.0, square = 0.0, rows = 0.0, strokes = 0.0;
  for (const Line& line : lines) {
    for (const Stroke* stroke : line.strokes) {
      const double sense = line.SenseOf(*stroke) - line.sense;
      const double expected = line.along - result.displacement * sense;
      left += line.weight * std::pow(stroke->along - expected, 2);
      square += line.weight * sense * sense;
      const Eigen::VectorXd along =
          readings.displacement(stroke->rows, Eigen::all) * line.seen / line.weight;
      rows += (along.array() - expected).square().sum();
      result.rows += stroke->rows.size();
      strokes += 1.0;
    }
  }
  result.dof = strokes - lines.size() - 1.0;
  result.u = result.dof > 0.0 ? std::sqrt(left / result.dof / square)
                              : std::numeric_limits<double>::infinity();
  result.scatter = std::sqrt(rows / result.rows);
}

CapDisplacement Evaluate(const Readings& readings, const std::vector<Eigen::Index>& rows,
                         const Eigen::Matrix3Xd& velocity, const std::string& recording) {
  std::vector<Stroke> strokes = StrokesOf(rows, velocity, readings.commanded);
  std::vector<Line> lines = LinesOf(strokes, readings, true);
  if (lines.empty()) lines = LinesOf(strokes, readings, false);
  if (lines.empty()) {
    throw InputError(
        fmt::format("{}: at {:.0f} mm/min the gauges see motion in one direction alone: the "
                    "displacement cannot be separated from their offsets; move to and fro",
                    recording, readings.feed[rows.front()] / settings::kMillimetre * 60.0));
  }
  CapDisplacement result;
  result.displacement = Displacement(lines);
  result.force = readings.force[rows.front()];
  result.feed = readings.feed[rows.front()];
  AddScatter(lines, readings, result);
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

}  // namespace abbe::paths
