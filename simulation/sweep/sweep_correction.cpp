#include "simulation/sweep/sweep_correction.h"

#include <fmt/format.h>

#include <algorithm>

#include "estimation/dual_number.h"
#include "recording/good_rows.h"
#include "simulation/correction_steps.h"
#include "simulation/sweep/sweep_reading.h"
#include "simulation/sweep/sweep_run.h"
#include "simulation/sweep/sweep_trace.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using recording::Recording;
using MotionJacobian = Eigen::Matrix<double, kProbes, kToolStage>;

// Every good row, as a run.
SweepRun RowsOf(const Recording& recording) {
  SweepRun run;
  run.name = recording.name;
  run.axis = recording.HeaderText("axis").value_or("X").front();
  run.first_rows = recording::GoodRows(recording);
  const auto column = [&](const std::string& name) -> VectorXd {
    const std::vector<double> values = recording::ValuesOf(recording, name, run.first_rows);
    return Eigen::Map<const VectorXd>(values.data(), values.size());
  };
  const auto whole = [&](const char* name) {
    const VectorXd values = column(name);
    return std::vector<int>(values.begin(), values.end());
  };
  for (Index axis = 0; axis < 3; ++axis) {
    const std::string name = PositionColumn(axis);
    run.start[axis] = recording.Find(name) ? column(name)[0] : 0.0;
  }
  run.position = column(PositionColumn(machine::AxisIndex(run.axis)));
  run.time = column("time_s");
  run.pass = whole("pass");
  run.direction = whole("direction");
  run.gap.resize(kProbes, run.rows());
  for (Index probe = 0; probe < run.gap.rows(); ++probe) {
    run.gap.row(probe) = column(fmt::format("probe_{}_um", "abcde"[probe])).transpose();
  }
  return run;
}

// What the probes of the nominal head read by the error motions of all axes.
MotionJacobian ReadingsByMotions(const SweepPlan& plan, const probes::HeadSettings& head,
                                 const Eigen::Vector3d& axes) {
  using Dual = estimation::DualNumber<kToolStage>;
  machine::MotionErrors<Dual> errors;
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      errors.axes[axis][motion].v[MotionStage(axis, motion)] = 1.0;
    }
  }
  const auto X_WT = ToolSeenFromWork<Dual>(plan, axes, errors);
  MotionJacobian J;
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    Circumstances<Dual> at;
    at.place = PlaceOf(head.layout, probe).cast<Dual>();
    at.gain = Dual(head.probes[probe].gain);
    for (auto* turn : {&at.turn, &at.shift, &at.tilt, &at.face_squareness}) {
      turn->setConstant(Dual(0.0));
    }
    J.row(probe) = ReadingOf<Dual>(plan, probe, X_WT, at).v.transpose();
  }
  return J;
}

}  // namespace

Correction CorrectSweep(const Recording& recording, const std::vector<ModelledCause>& causes,
                        const Origin& origin, const Instruments& on) {
  const probes::HeadSettings& head = on.HeadFor(recording.name);
  Correction corrected{recording, {}};
  const SweepRun run = RowsOf(recording);
  Trace trace = TraceOf(recording, run);
  trace.head->zero = run.gap.col(0);  // as the causes define it: the gap at the start
  Sums sums = SumsOf(trace, causes, origin);
  const int swept = machine::AxisIndex(run.axis);
  const Eigen::RowVectorXd along = sums.machine.row(Positioning(swept));
  sums.machine.row(Positioning(swept)).setZero();
  const SweepPlan plan = MakeSweepPlan(on.machine.chain, on.machine.reference, head, run);
  Moved position(corrected.recording, PositionColumn(swept), corrected.changes.positions);
  std::vector<Moved> gaps;
  for (const char probe : {'a', 'b', 'c', 'd', 'e'}) {
    gaps.emplace_back(corrected.recording, fmt::format("probe_{}_um", probe),
                      corrected.changes.gaps);
  }
  const Eigen::MatrixXd sum = sums.machine + sums.instrument;
  for (Index row = 0; row < run.rows(); ++row) {
    const std::size_t at = run.first_rows[row];
    position.By(at, along[row]);
    const auto motions = sum.col(row).head<kToolStage>();
    Eigen::Matrix<double, kProbes, 1> shown = sum.col(row).segment<kProbes>(kReadingStage);
    if (!motions.isZero(0.0)) {
      shown += ReadingsByMotions(plan, head, run.AxesAt(row)) * motions;
    }
    for (std::size_t probe = 0; probe < kProbes; ++probe) {
      gaps[probe].By(at, -shown[probe]);
    }
  }
  return corrected;
}

}  // namespace abbe::simulation
