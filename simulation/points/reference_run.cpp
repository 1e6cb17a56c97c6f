#include "simulation/points/reference_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "failure/failure.h"
#include "simulation/linkage/linkage_run.h"
#include "simulation/trace_columns.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using recording::Recording;

constexpr const char* kStatedColumn = "ref_u_um";
constexpr const char* kStatedKey = "u_reference_um";

void ReadPlaces(const Recording& recording, ReferenceRun& run) {
  run.place = Eigen::Matrix3Xd::Zero(3, run.rows());
  for (Index axis = 0; axis < 3; ++axis) {
    const std::string column = fmt::format("ref_{}_mm", "xyz"[axis]);
    if (!recording.Find(column)) continue;
    run.shown[axis] = true;
    run.place.row(axis) = ColumnAt(recording, run.points, column).transpose();
  }
  if (std::find(run.shown.begin(), run.shown.end(), true) != run.shown.end()) return;
  throw InputError(
      fmt::format("{}: has none of ref_x_mm, ref_y_mm, ref_z_mm: nothing says where "
                  "the tool really was",
                  recording.name));
}

void ReadStatedNoise(const Recording& recording, ReferenceRun& run) {
  const double u_scale = recording.HeaderNumber("u_scale_ppm", 0.0).value_or(0.0);
  if (!(u_scale >= 0.0)) {
    throw InputError(fmt::format(
        "{}: u_scale_ppm = {} in the header: write how well the scale of the reference is known, 0 "
        "or above",
        recording.name, u_scale));
  }
  run.u_scale = 1e-6 * u_scale;
  run.sd = Eigen::Matrix3Xd::Zero(3, run.rows());
  const auto stated = recording.HeaderNumber(kStatedKey);
  const bool by_row = recording.Find(kStatedColumn).has_value();
  if (!stated && !by_row) return;
  if (stated) run.sd.setConstant(1e-6 * *stated);
  if (by_row) {
    run.sd.rowwise() = ColumnAt(recording, run.points, kStatedColumn).transpose();
  }
  if (run.sd.minCoeff() > 0.0) return;
  throw InputError(fmt::format("{}: {} must be above 0: it is the noise of the reference",
                               recording.name, by_row ? kStatedColumn : kStatedKey));
}

char TestedAxis(const Recording& recording, const ReferenceRun& run) {
  const auto approach = [](int direction) { return direction == 1 || direction == -1; };
  if (!recording.Find("direction") ||
      !std::all_of(run.direction.begin(), run.direction.end(), approach)) {
    return ' ';
  }
  char tested = ' ';
  for (Index axis = 0; axis < 3; ++axis) {
    const auto& positions = run.points.axes.row(axis);
    if (positions.maxCoeff() - positions.minCoeff() <= kStayWindow) continue;
    if (tested != ' ') return ' ';
    tested = "XYZ"[axis];
  }
  return tested;
}

// The rows [first, last) that become one.
struct Together {
  Index first, last;
};

ReferenceRun Gathered(const ReferenceRun& run, const std::vector<Together>& each) {
  ReferenceRun gathered = run;
  const Index count = each.size();
  gathered.points.rows.resize(each.size());
  gathered.points.axes.resize(3, count);
  gathered.place.resize(3, count);
  gathered.sd.resize(3, count);
  gathered.time.resize(count);
  gathered.pass.resize(each.size());
  gathered.direction.resize(each.size());
  for (std::size_t i = 0; i < each.size(); ++i) {
    const Index first = each[i].first, rows = each[i].last - first;
    gathered.points.rows[i] = run.points.rows[first];
    gathered.points.axes.col(i) = run.points.axes.middleCols(first, rows).rowwise().mean();
    gathered.place.col(i) = run.place.middleCols(first, rows).rowwise().mean();
    gathered.sd.col(i) = run.sd.middleCols(first, rows).rowwise().mean();
    gathered.time[i] = run.time.segment(first, rows).mean();
    gathered.pass[i] = run.pass[first];
    gathered.direction[i] = run.direction[first];
  }
  return gathered;
}

}  // namespace

ReferenceRun ReadReferenceRun(const Recording& recording) {
  ReferenceRun run;
  run.points = ReadMachinePoints(recording);
  ReadPlaces(recording, run);
  ReadStatedNoise(recording, run);
  run.timed = recording.KnowsTimes();
  run.time = recording.Find("time_s") ? ColumnAt(recording, run.points, "time_s")
                                      : Eigen::VectorXd::LinSpaced(run.rows(), 0.0, run.rows() - 1);
  run.pass = IntegersAt(recording, "pass", run.points.rows);
  run.direction = IntegersAt(recording, "direction", run.points.rows);
  run.tested = TestedAxis(recording, run);
  return run;
}

Recording WithAllAxes(Recording recording, const std::array<machine::Travel, 3>& travels) {
  for (std::size_t axis = 0; axis < travels.size(); ++axis) {
    const std::string column = fmt::format("{}_mm", "xyz"[axis]);
    if (recording.Find(column)) continue;
    const double place = std::clamp(0.0, travels[axis].first, travels[axis].last);
    const std::vector<double> values(recording.rows(), 1e3 * place);
    recording.columns.push_back({column, values});
  }
  return recording;
}

ReferenceRun MeansOfStays(const ReferenceRun& run) {
  std::vector<Together> stays;
  for (Index row = 0; row < run.rows(); ++row) {
    const auto stays_on = [&](const Together& stay) {
      const std::size_t first = stay.first;
      const auto moved = run.points.axes.col(row) - run.points.axes.col(stay.first);
      return run.pass[row] == run.pass[first] && run.direction[row] == run.direction[first] &&
             moved.cwiseAbs().maxCoeff() <= kStayWindow;
    };
    if (!stays.empty() && stays_on(stays.back())) {
      stays.back().last = row + 1;
    } else {
      stays.push_back({row, row + 1});
    }
  }
  return Gathered(run, stays);
}

ReferenceRun Thinned(const ReferenceRun& run, Index most) {
  if (run.rows() <= most) return run;
  const Index step = (run.rows() + most - 1) / most;
  std::vector<Together> kept;
  for (Index row = 0; row < run.rows(); row += step) kept.push_back({row, row + 1});
  return Gathered(run, kept);
}

}  // namespace abbe::simulation
