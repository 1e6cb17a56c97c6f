#include "diagnosis/planned_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "failure/failure.h"
#include "recording/good_rows.h"
#include "simulation/arm/arm_run.h"
#include "simulation/linkage/linkage_run.h"
#include "simulation/linkage/linkage_simulation.h"

namespace abbe::diagnosis {
namespace {

using Eigen::Index;
using recording::Recording;

constexpr double kMicrometre = 1e-6;

// +1, +1, -1, -1 ...; channels one after the other differ.
double Sign(std::size_t row, std::size_t channel) { return (row + channel) % 4 < 2 ? 1.0 : -1.0; }

// A row counts when it has a place.
void SetFlags(Recording& path) {
  auto& flags = ColumnIn(path, "flags");
  std::fill(flags.begin(), flags.end(), 0.0);
  for (const char* axis : {"x_mm", "y_mm", "z_mm"}) {
    const auto position = path.At(axis);
    for (std::size_t row = 0; row < flags.size(); ++row) {
      if (!std::isfinite(position[row])) flags[row] = recording::kDeviceError;
    }
  }
}

Eigen::Matrix3Xd PositionsOf(const Recording& path, const std::vector<std::size_t>& rows) {
  Eigen::Matrix3Xd positions(3, static_cast<Index>(rows.size()));
  for (Index axis = 0; axis < 3; ++axis) {
    const auto values = recording::ValuesOf(path, fmt::format("{}_mm", "xyz"[axis]), rows);
    positions.row(axis) = Eigen::Map<const Eigen::RowVectorXd>(values.data(), positions.cols());
  }
  return positions;
}

void SetGaps(const Setup& setup, Recording& path) {
  for (std::size_t probe = 0; probe < probes::kProbes; ++probe) {
    const double middle = 0.5 * setup.head->probes[probe].range;
    auto& gap = ColumnIn(path, fmt::format("probe_{}_um", static_cast<char>('a' + probe)));
    for (std::size_t row = 0; row < gap.size(); ++row) {
      gap[row] = (middle + Sign(row, probe) * setup.noise.probe) / kMicrometre;
    }
  }
}

}  // namespace

std::vector<double>& ColumnIn(Recording& recording, const std::string& name) {
  const auto found = std::find_if(recording.columns.begin(), recording.columns.end(),
                                  [&](const auto& column) { return column.name == name; });
  if (found != recording.columns.end()) return found->values;
  recording.columns.push_back({name, std::vector<double>(recording.rows(), 0.0)});
  return recording.columns.back().values;
}

void SetAngles(const Setup& setup, const relm::LinkageSettings& linkage, Recording& path) {
  const simulation::LinkageSimulation nominal(
      setup.machine.chain, linkage, relm::MakeLinkageModel(linkage, relm::ErrorModel::kComplete));
  const std::vector<std::size_t> rows = recording::GoodRows(path);
  simulation::LinkageRun run = simulation::RunAt(PositionsOf(path, rows), linkage);
  run.name = path.name;
  const Eigen::MatrixXd angles = nominal.Readings(run, nominal.Values());
  for (Index pivot = 0; pivot < angles.rows(); ++pivot) {
    auto& column = ColumnIn(path, fmt::format("pivot_{}_rad", pivot + 1));
    double before = 0.0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      // A turn on, not a jump by a turn, where an angle passes pi.
      const double angle = angles(pivot, static_cast<Index>(i));
      before += std::remainder(angle - before, 2.0 * std::numbers::pi);
      column[rows[i]] = before + Sign(i, static_cast<std::size_t>(pivot)) * linkage.noise.encoder;
    }
  }
}

Recording Planned(Recording path, const Setup& setup) {
  const std::string kind = path.Kind();
  if (kind == "shaft") {
    throw InputError(
        fmt::format("{}: a turning shaft cannot be planned yet; leave the run out", path.name));
  }
  SetFlags(path);
  if (simulation::IsArm(path)) {
    throw InputError(fmt::format(
        "{}: has no axis positions x_mm, y_mm, z_mm: the poses of an arm cannot be planned with",
        path.name));
  }
  if (kind == "linkage") {
    if (!setup.linkage) {
      throw InputError(fmt::format(
          "{}: the machine file has no table [linkage]; add it or leave the run out", path.name));
    }
    SetAngles(setup, *setup.linkage, path);
  } else if (kind == "sweep" || kind == "dwell" || kind == "gap-steps") {
    SetGaps(setup, path);
  }
  return path;
}

}  // namespace abbe::diagnosis
