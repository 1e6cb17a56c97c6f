#include "simulation/trace.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "relm/linkage_model.h"
#include "simulation/trace_columns.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

constexpr double kAxisBand = 2e-6;    // m: more than a scale trembles
constexpr double kPivotBand = 50e-6;  // rad: more than an encoder trembles
constexpr double kGap = 0.5;          // s between rows: nothing is known of the way between

// Whether nothing is known of the way from the row before.
bool Begins(const Trace& trace, Index row) {
  const auto at = static_cast<std::size_t>(row);
  return row == 0 || trace.pass[at] != trace.pass[at - 1] ||
         trace.direction[at] != trace.direction[at - 1] ||
         trace.time[row] - trace.time[row - 1] > kGap;
}

// First and second derivative by time of each row of `values`, from the parabola through three
// neighbours of one pass; 0 where there are none.
struct Derivatives {
  MatrixXd first, second;
};

Derivatives DerivativesOf(const MatrixXd& values, const Trace& trace) {
  Derivatives found{MatrixXd::Zero(values.rows(), values.cols()),
                    MatrixXd::Zero(values.rows(), values.cols())};
  Index first = 0;
  for (Index row = 0; row < values.cols(); ++row) {
    if (Begins(trace, row)) first = row;
    Index last = row;
    while (last + 1 < values.cols() && last < row + 2 && !Begins(trace, last + 1)) ++last;
    if (last - first < 2) continue;
    const Index middle = std::clamp(row, first + 1, last - 1);
    const double before = trace.time[middle] - trace.time[middle - 1];
    const double after = trace.time[middle + 1] - trace.time[middle];
    const VectorXd rise = (values.col(middle) - values.col(middle - 1)) / before;
    const VectorXd next = (values.col(middle + 1) - values.col(middle)) / after;
    found.second.col(row) = 2.0 * (next - rise) / (before + after);
    found.first.col(row) = (rise * after + next * before) / (before + after) +
                           found.second.col(row) * (trace.time[row] - trace.time[middle]);
  }
  return found;
}

RowVectorXd ApproachOf(const std::vector<int>& direction) {
  RowVectorXd heading(static_cast<Index>(direction.size()));
  std::copy(direction.begin(), direction.end(), heading.begin());
  return heading;
}

// Metres since the heading last changed. Before a pass began the axis moved as it then did.
RowVectorXd SinceReversal(const Trace& trace, Index axis) {
  constexpr double kBefore = 0.5;  // s
  const RowVectorXd& position = trace.axes.row(axis);
  RowVectorXd since = RowVectorXd::Constant(position.size(), kLongAgo);
  std::optional<double> turned;
  for (Index row = 0; row < position.size(); ++row) {
    const double velocity = trace.velocity(axis, row), acceleration = trace.acceleration(axis, row);
    if (acceleration != 0.0 && Begins(trace, row)) {
      const double ago = velocity / acceleration;
      turned.reset();
      if (ago > -kBefore && ago < kBefore) turned = position[row] - 0.5 * velocity * ago;
    } else if (row > 0 && trace.heading(axis, row) != trace.heading(axis, row - 1)) {
      turned = position[row - 1];
    }
    if (turned) since[row] = std::abs(position[row] - *turned);
  }
  return since;
}

// The output of a play less its input, in widths. What moved before a pass began is told from how
// it began; between two rows the way is a cubic.
RowVectorXd PlayOf(const RowVectorXd& position, const Trace& trace, double width) {
  constexpr double kBefore = 0.5;  // s
  constexpr int kSteps = 8;        // between two rows, and before the first
  const Derivatives motion = DerivativesOf(position, trace);
  const double half = 0.5 * width;
  double out = position[0];
  const auto pull = [&](double in) { out = std::clamp(out, in - half, in + half); };
  RowVectorXd behind(position.size());
  for (Index row = 0; row < position.size(); ++row) {
    const double velocity = motion.first(0, row), acceleration = motion.second(0, row);
    const bool moves = velocity != 0.0 || acceleration != 0.0;
    if (moves && Begins(trace, row)) {
      out = position[row] - kBefore * velocity + 0.5 * kBefore * kBefore * acceleration;
      for (int step = kSteps; step > 0; --step) {
        const double ago = kBefore * step / kSteps;
        pull(position[row] - ago * velocity + 0.5 * ago * ago * acceleration);
      }
    } else if (moves) {
      const double seconds = trace.time[row] - trace.time[row - 1];
      const double from = position[row - 1], to = position[row];
      const double start = motion.first(0, row - 1) * seconds, end = velocity * seconds;
      for (int step = 1; step < kSteps; ++step) {
        const double s = static_cast<double>(step) / kSteps, r = 1.0 - s;
        pull(r * r * (1.0 + 2.0 * s) * from + s * s * (1.0 + 2.0 * r) * to + s * r * r * start -
             s * s * r * end);
      }
    }
    pull(position[row]);
    behind[row] = (out - position[row]) / width;
  }
  return behind;
}

// Where the cap goes; while standing, where it went last.
Eigen::Matrix3Xd WayOf(const Trace& trace, const machine::Chain& chain) {
  constexpr double kSoon = 1e-3;  // s
  const auto tip = [&](const Eigen::Vector3d& axes) { return relm::NominalTip(chain, axes); };
  Eigen::Matrix3Xd way = Eigen::Matrix3Xd::Zero(3, trace.rows());
  Index first = trace.rows();
  for (Index row = 0; row < trace.rows(); ++row) {
    const Eigen::Vector3d here = trace.axes.col(row), velocity = trace.velocity.col(row);
    Eigen::Vector3d moved = Eigen::Vector3d::Zero();
    if (velocity.norm() > 0.0) {
      moved = (tip(here + kSoon * velocity) - tip(here)).normalized();
    } else if (row > 0 && (here - trace.axes.col(row - 1)).norm() > kAxisBand) {
      moved = (tip(here) - tip(trace.axes.col(row - 1))).normalized();
    } else if (row > 0) {
      moved = way.col(row - 1);
    }
    way.col(row) = moved;
    if (first == trace.rows() && !moved.isZero(0.0)) first = row;
  }
  if (first < trace.rows()) way.leftCols(first).colwise() = Eigen::Vector3d(way.col(first));
  return way;
}

// Pivots whose axes meet have no link between them: they move the next one.
MatrixXd LinksOf(const LinkageRun& run, const relm::LinkageModel& model) {
  const std::vector<std::string> names = model.Names();
  const VectorXd nominal = model.Values();
  const Index pivots = run.readings.angles.rows();
  MatrixXd links = MatrixXd::Zero(3 * pivots, run.poses());
  for (Index row = 0; row < run.poses(); ++row) {
    // What one unit of expansion does at a warmth of 1 K: the link itself.
    const auto at = model.Differentiate(run.readings.angles.col(row), 1.0, nominal);
    Eigen::Vector3d link = Eigen::Vector3d::Zero();
    for (Index pivot = pivots - 1; pivot >= 0; --pivot) {
      const auto found =
          std::find(names.begin(), names.end(), fmt::format("expansion.after_pivot_{}", pivot + 1));
      if (found != names.end()) {
        const Eigen::Vector3d own = at.J_tip_x.col(found - names.begin());
        if (own.norm() > 0.0) link = own.normalized();
      }
      links.block<3, 1>(3 * pivot, row) = link;
    }
  }
  return links;
}

}  // namespace

RowVectorXd Trace::Behind(int which, double width) const {
  // Between the stations of a sweep, and the targets of a test, any play is taken up.
  const bool follows =
      kind == "linkage" || (kind == "reference" && !velocity.row(which).isZero(0.0));
  if (!follows || width <= 0.0) return -0.5 * heading.row(which);
  return PlayOf(axes.row(which), *this, width);
}

RowVectorXd Trace::PivotBehind(int pivot, double width) const {
  if (width <= 0.0) return -0.5 * turning.row(pivot);
  return PlayOf(angles.row(pivot), *this, width);
}

void Trace::SetAxes(const Eigen::Matrix3Xd& path) {
  axes = path;
  const Derivatives motion = DerivativesOf(axes, *this);
  velocity = motion.first;
  acceleration = motion.second;
  heading.resize(3, axes.cols());
  since_reversal.resize(3, axes.cols());
  for (Index i = 0; i < 3; ++i) {
    heading.row(i) = "XYZ"[i] == axis ? ApproachOf(direction) : HeadingOf(axes.row(i), kAxisBand);
    since_reversal.row(i) = SinceReversal(*this, i);
  }
}

void Trace::SetAngles(const MatrixXd& nearer) {
  angles = nearer;
  turning.resize(pivots(), nearer.cols());
  for (Index pivot = 0; pivot < pivots(); ++pivot) {
    turning.row(pivot) = HeadingOf(angles.row(pivot), kPivotBand);
  }
}

RowVectorXd HeadingOf(const RowVectorXd& position, double band) {
  RowVectorXd heading = RowVectorXd::Zero(position.size());
  if (position.size() == 0) return heading;
  double extreme = position[0], now = 0.0;
  Index first = position.size();
  for (Index row = 1; row < position.size(); ++row) {
    const double moved = position[row] - extreme;
    if (moved * now > 0.0 || (now == 0.0 && std::abs(moved) > band)) {
      if (now == 0.0) first = row;
      now = moved > 0.0 ? 1.0 : -1.0;
      extreme = position[row];
    } else if (moved * now < -0.0 && std::abs(moved) > band) {
      now = -now;
      extreme = position[row];
    }
    heading[row] = now;
  }
  if (first < position.size()) heading.head(first).setConstant(heading[first]);
  return heading;
}

Trace TraceOf(const recording::Recording& recording, const SweepRun& run) {
  Trace trace;
  trace.name = run.name;
  trace.kind = recording.Kind();
  trace.axis = run.axis;
  trace.mounting = run.mounting;
  trace.started = StartedOf(recording);
  trace.time = trace.clock = run.time;
  trace.pass = run.pass;
  trace.direction = run.direction;
  trace.axes.resize(3, run.rows());
  for (Index row = 0; row < run.rows(); ++row) trace.axes.col(row) = run.AxesAt(row);
  trace.velocity = trace.acceleration = trace.heading = Eigen::Matrix3Xd::Zero(3, run.rows());
  trace.since_reversal = Eigen::Matrix3Xd::Constant(3, run.rows(), kLongAgo);
  const Index swept = run.axis - 'X';
  // The direction of approach, not the last difference: at the end of a pass the axis overruns.
  trace.heading.row(swept) = ApproachOf(run.direction);
  if (trace.kind == "gap-steps") {
    for (Index k = 0; k < 3; ++k) trace.heading.row(k) = HeadingOf(trace.axes.row(k), kAxisBand);
  }
  for (Index k = 0; k < 3; ++k) trace.since_reversal.row(k) = SinceReversal(trace, k);
  trace.gap = run.gap;
  trace.zero = run.gap.rowwise().mean();
  AddSensors(recording, run.first_rows, trace);
  return trace;
}

Trace TraceOf(const recording::Recording& recording, const LinkageRun& run,
              const LinkageSimulation& linkage) {
  Trace trace;
  trace.name = run.name;
  trace.kind = "linkage";
  trace.mounting = run.mounting;
  trace.started = StartedOf(recording);
  trace.time = trace.clock = run.time;
  trace.pass = IntegersAt(recording, "pass", run.rows);
  trace.direction = IntegersAt(recording, "direction", run.rows);
  trace.SetAxes(run.commanded);
  trace.SetAngles(run.readings.angles);
  trace.ball_way = WayOf(trace, linkage.chain());
  trace.link = LinksOf(run, linkage.model());
  AddSensors(recording, run.rows, trace);
  return trace;
}

Disturbance NoDisturbance(const Trace& trace) { return Disturbance(trace.rows()); }

}  // namespace abbe::simulation
