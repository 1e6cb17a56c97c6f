#include "simulation/linkage/linkage_trace.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "failure/failure.h"
#include "relm/linkage_model.h"
#include "simulation/trace_columns.h"
#include "simulation/trace_motion.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Where the cap goes; while standing, where it went last; 0 before it moves.
Eigen::Matrix3Xd WayOf(const Trace& trace, const machine::Chain& chain) {
  constexpr double kSoon = 1e-3;  // s
  const auto tip = [&](const Eigen::Vector3d& axes) { return relm::NominalTip(chain, axes); };
  Eigen::Matrix3Xd way = Eigen::Matrix3Xd::Zero(3, trace.rows());
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
  }
  return way;
}

// The time of a stay is the mean of its readings.
VectorXd LastingOf(const recording::Recording& recording, const LinkageRun& run) {
  VectorXd duration = VectorXd::Zero(run.poses());
  const auto time = recording.Find("time_s");
  if (!time) return duration;
  for (Index pose = 0; pose < run.poses(); ++pose) {
    if (run.samples[pose] == 1.0) continue;
    duration[pose] = 2.0 * (run.time[pose] - (*time)[run.rows[pose]]);
  }
  return duration;
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

// By how much each pivot is beside a straight line between its angles in two rows that stand, when
// the axes go straight from one to the other: kWaySteps rows for each pivot.
MatrixXd BulgeOf(const Trace& trace, const LinkageRun& run, const LinkageSimulation& linkage) {
  std::vector<Index> stays;
  for (Index row = 1; row < trace.rows(); ++row) {
    const bool moved = (trace.axes.col(row) - trace.axes.col(row - 1)).norm() > kAxisBand;
    if (moved && trace.velocity.col(row).isZero(0.0)) stays.push_back(row);
  }
  if (stays.empty()) return {};
  const Index pivots = trace.pivots();
  MatrixXd bulge = MatrixXd::Zero(pivots * kWaySteps, trace.rows());
  for (const Index row : stays) {
    LinkageRun way = Selection(run, std::vector<Index>(kWaySteps + 1, row));
    for (Index step = 0; step <= kWaySteps; ++step) {
      const double s = static_cast<double>(step) / kWaySteps;
      way.reference.col(step) = (1.0 - s) * trace.axes.col(row - 1) + s * trace.axes.col(row);
    }
    MatrixXd angles;
    try {
      angles = linkage.Readings(way, linkage.Values(), run.readings.angles.col(row - 1));
    } catch (const NumericalError&) {
      continue;  // not that way
    }
    for (Index pivot = 0; pivot < pivots; ++pivot) {
      for (Index step = 0; step < kWaySteps; ++step) {
        const double s = static_cast<double>(step) / kWaySteps;
        bulge(pivot * kWaySteps + step, row) =
            angles(pivot, step) - (1.0 - s) * angles(pivot, 0) - s * angles(pivot, kWaySteps);
      }
    }
  }
  return bulge;
}

// All but the way of the axes and of the ball.
Trace PivotsOfRun(const recording::Recording& recording, const LinkageRun& run,
                  const LinkageSimulation& linkage) {
  Trace trace;
  trace.name = run.name;
  trace.mounting = run.mounting;
  trace.started = StartedOf(recording);
  trace.time = trace.clock = run.time;
  trace.samples = run.samples;
  trace.duration = LastingOf(recording, run);
  trace.pass = IntegersAt(recording, "pass", run.rows);
  trace.direction = IntegersAt(recording, "direction", run.rows);
  trace.SetAngles(run.readings.angles);
  trace.linkage->link = LinksOf(run, linkage.model());
  AddSensors(recording, run.rows, trace);
  return trace;
}

}  // namespace

Trace TraceOf(const recording::Recording& recording, const LinkageRun& run,
              const LinkageSimulation& linkage) {
  Trace trace = PivotsOfRun(recording, run, linkage);
  trace.continuous = true;
  trace.on_the_way = OnTheWay::kAlways;
  trace.SetAxes(run.commanded);
  trace.linkage->angle_bulge = BulgeOf(trace, run, linkage);
  trace.linkage->cap_direction = WayOf(trace, linkage.chain());
  return trace;
}

// Less pivot_1_commanded_rad ...; empty unless all are there.
MatrixXd BehindCommands(const recording::Recording& recording, const LinkageRun& run) {
  MatrixXd behind = run.readings.angles;
  for (Index pivot = 0; pivot < behind.rows(); ++pivot) {
    const auto sent = recording.Find(fmt::format("pivot_{}_commanded_rad", pivot + 1));
    if (!sent) return {};
    for (Index pose = 0; pose < run.poses(); ++pose) {
      const std::size_t row = run.rows[pose] - recording.first_row;
      // A command may count a turn more.
      behind(pivot, pose) =
          std::remainder(behind(pivot, pose) - (*sent)[row], 2.0 * std::numbers::pi);
    }
  }
  return behind;
}

Trace ArmTraceOf(const recording::Recording& recording, const LinkageRun& run,
                 const LinkageSimulation& linkage) {
  Trace trace = PivotsOfRun(recording, run, linkage);
  trace.linkage->is_arm = true;
  trace.linkage->behind = BehindCommands(recording, run);
  trace.SetAxes(run.reference);
  trace.linkage->cap_direction = Eigen::Matrix3Xd::Zero(3, trace.rows());
  return trace;
}

}  // namespace abbe::simulation
