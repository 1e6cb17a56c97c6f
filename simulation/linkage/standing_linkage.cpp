#include "simulation/linkage/standing_linkage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "recording/good_rows.h"
#include "simulation/linkage/linkage_on_machine.h"
#include "simulation/linkage/linkage_run.h"
#include "simulation/linkage/linkage_simulation.h"
#include "simulation/linkage/linkage_trace.h"
#include "simulation/planned_run.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using recording::Recording;

bool ShowsLinkage(const Recording& recording, const relm::LinkageSettings& linkage) {
  for (const char* axis : {"x_mm", "y_mm", "z_mm"}) {
    if (!recording.Find(axis)) return false;
  }
  for (Index joint = 1; joint <= linkage.chain.joints(); ++joint) {
    if (!recording.Find(fmt::format("pivot_{}_rad", joint))) return false;
  }
  return true;
}

Eigen::Matrix3Xd PositionsOf(const Recording& path, const std::vector<std::size_t>& rows) {
  Eigen::Matrix3Xd positions(3, static_cast<Index>(rows.size()));
  for (Index axis = 0; axis < 3; ++axis) {
    const auto values = recording::ValuesOf(path, fmt::format("{}_mm", "xyz"[axis]), rows);
    positions.row(axis) = Eigen::Map<const Eigen::RowVectorXd>(values.data(), positions.cols());
  }
  return positions;
}

// Each block of readings as one pose, all at one place.
LinkageRun InBlocks(const LinkageRun& run) {
  const Index block = (run.poses() + kStandingBlocks - 1) / kStandingBlocks;
  LinkageRun means = Blank(run, (run.poses() + block - 1) / block);
  for (Index row = 0; row < means.poses(); ++row) {
    const Index first = row * block, count = std::min(block, run.poses() - first);
    means.rows[static_cast<std::size_t>(row)] = run.rows[static_cast<std::size_t>(first)];
    means.time[row] = run.time.segment(first, count).mean();
    means.readings.angles.col(row) = run.readings.angles.middleCols(first, count).rowwise().mean();
    if (run.readings.warmth.size() > 0) {
      means.readings.warmth[row] = run.readings.warmth.segment(first, count).mean();
    }
    means.samples[row] = static_cast<double>(count);
  }
  means.commanded.colwise() = run.commanded.rowwise().mean().eval();
  means.reference = means.commanded;
  means.reference_sd.setZero();
  return means;
}

}  // namespace

std::optional<PreparedRun> StandingLinkage(const Recording& recording,
                                           const machine::VolumetricModel& model,
                                           const Instruments& on) {
  if (!on.linkage || !ShowsLinkage(recording, *on.linkage)) return {};
  const LinkageRun whole = ReadLinkageRun(recording, *on.linkage);
  const auto way = whole.commanded.colwise() - whole.commanded.rowwise().mean().eval();
  if (whole.poses() == 0 || way.cwiseAbs().maxCoeff() > kStayWindow) return {};
  LinkageRun run = InBlocks(whole);
  run.name += " (encoders)";
  const LinkageSimulation nominal{on.machine.chain, *on.linkage,
                                  relm::MakeLinkageModel(*on.linkage, relm::ErrorModel::kComplete)};
  Trace trace = TraceOf(recording, run, nominal);
  CountIndependent(on.linkage->noise, trace.duration, run);
  return PreparedRun{SimulateStandingLinkage(model, on.machine.reference, nominal, run),
                     std::move(trace)};
}

// Nominal angles that close the linkage, each with its noise.
void PlanAngles(const Instruments& on, Recording& path) {
  const relm::LinkageSettings& linkage = on.LinkageFor(path.name);
  const LinkageSimulation nominal{on.machine.chain, linkage,
                                  relm::MakeLinkageModel(linkage, relm::ErrorModel::kComplete)};
  const std::vector<std::size_t> rows = recording::GoodRows(path);
  LinkageRun run = RunAt(PositionsOf(path, rows), linkage);
  run.name = path.name;
  const Eigen::MatrixXd angles = nominal.Readings(run, nominal.Values());
  for (Index pivot = 0; pivot < angles.rows(); ++pivot) {
    auto& column = ColumnIn(path, fmt::format("pivot_{}_rad", pivot + 1));
    double before = 0.0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      // A turn on, not a jump by a turn, where an angle passes pi.
      const double angle = angles(pivot, static_cast<Index>(i));
      before += std::remainder(angle - before, 2.0 * std::numbers::pi);
      column[rows[i]] =
          before + MixedSign(i, static_cast<std::size_t>(pivot)) * linkage.noise.encoder;
    }
  }
}

}  // namespace abbe::simulation
