#include "simulation/ballbar/ballbar_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "failure/failure.h"
#include "settings/unit.h"
#include "simulation/trace_columns.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using recording::Recording;

constexpr const char* kNoiseKey = "u_radius_um";

// From the third differences of readings that follow each other; 0 where they are too few.
double ScatterOf(const BallbarRun& run) {
  constexpr std::size_t kFewestDifferences = 30;
  constexpr double kOfNormal = 1.4826, kOfDifference = 20.0;  // 1 + 9 + 9 + 1
  std::vector<double> sizes;
  for (Index i = 3; i < run.rows(); ++i) {
    if (run.pass[i] != run.pass[i - 3]) continue;
    const auto& r = run.radius;
    sizes.push_back(std::abs(r[i] - 3.0 * r[i - 1] + 3.0 * r[i - 2] - r[i - 3]));
  }
  if (sizes.size() < kFewestDifferences) return 0.0;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  const double of_most = kOfNormal * *middle;
  // Half of them and more are zero where the readings are coarse.
  const double of_all = std::sqrt(
      std::inner_product(sizes.begin(), sizes.end(), sizes.begin(), 0.0) / std::ssize(sizes));
  return (of_most > 0.0 ? of_most : of_all) / std::sqrt(kOfDifference);
}

double NoiseOf(const Recording& recording, const BallbarRun& run) {
  constexpr double kSameReading = 1e-12;  // m
  if (const auto stated = recording.HeaderNumber(kNoiseKey)) {
    if (*stated > 0.0) return *stated * settings::kMicrometre;
    throw InputError(fmt::format("{}: {} must be above 0: it is the noise of the ballbar",
                                 recording.name, kNoiseKey));
  }
  const double scatter = ScatterOf(run);
  if (scatter > kSameReading) return std::max(scatter, kFinestBallbarNoise);
  throw InputError(
      fmt::format("{}: the noise of the ballbar is not known: its readings are too few, or too "
                  "coarse, to show it; state {} in the header",
                  recording.name, kNoiseKey));
}

// The rows in whose pass each axis that moves has gone some way.
std::vector<Index> UnderWay(const BallbarRun& run) {
  constexpr double kSomeWay = 20e-6;  // m
  std::vector<Index> rows;
  Index first = 0;
  while (first < run.rows()) {
    Index last = first;
    while (last < run.rows() && run.pass[last] == run.pass[first]) ++last;
    const auto own = run.points.axes.middleCols(first, last - first);
    const Eigen::Array3d range = own.rowwise().maxCoeff() - own.rowwise().minCoeff();
    Eigen::Array3d gone = Eigen::Array3d::Zero();
    for (Index i = first; i < last; ++i) {
      gone = gone.max((run.points.axes.col(i) - run.points.axes.col(first)).array().abs());
      if ((gone > kSomeWay || range <= kSomeWay).all()) rows.push_back(i);
    }
    first = last;
  }
  return rows;
}

BallbarRun With(const BallbarRun& run, const std::vector<Index>& kept) {
  BallbarRun some = run;
  some.points.axes = run.points.axes(Eigen::all, kept);
  some.radius = run.radius(kept);
  some.time = run.time(kept);
  some.points.rows.clear();
  some.pass.clear();
  for (const Index row : kept) {
    some.points.rows.push_back(run.points.rows[row]);
    some.pass.push_back(run.pass[row]);
  }
  return some;
}

VectorXd TimesOf(const Recording& recording, const BallbarRun& run) {
  constexpr double kBetweenPasses = 1.0;  // s
  if (run.times_known || (!run.feed_known && recording.Find("time_s"))) {
    return ColumnAt(recording, run.points, "time_s");
  }
  VectorXd feed = VectorXd::Zero(run.rows());
  if (run.feed_known) feed = ColumnAt(recording, run.points, "feed_mm_min");
  VectorXd time = VectorXd::Zero(run.rows());
  for (Index i = 1; i < run.rows(); ++i) {
    const double way = (run.points.axes.col(i) - run.points.axes.col(i - 1)).norm();
    const bool goes_on = run.pass[i] == run.pass[i - 1] && feed[i] > 0.0 && way > 0.0;
    time[i] = time[i - 1] + (goes_on ? way / feed[i] : kBetweenPasses);
  }
  return time;
}

}  // namespace

Recording WithAllPositions(Recording recording) {
  for (const char* axis : {"x_mm", "y_mm", "z_mm"}) {
    if (recording.Find(axis)) continue;
    recording.columns.push_back({axis, std::vector<double>(recording.rows(), 0.0)});
  }
  return recording;
}

BallbarRun ReadBallbarRun(const Recording& recording, double noise) {
  const auto centre = HeaderPoint(recording, "centre_mm");
  if (!centre) {
    throw InputError(
        fmt::format("{}: does not say where on the machine the circle was; state centre_mm = [x, "
                    "y, z] in its header, where the axes stand with the tool at the centre ball "
                    "(abbe convert --centre-mm)",
                    recording.name));
  }
  BallbarRun run;
  run.points = ReadMachinePoints(WithAllPositions(recording));
  run.centre = *centre;
  run.points.axes.colwise() += *centre;
  run.radius = ColumnAt(recording, run.points, "ref_radius_mm");
  for (Index i = 0; i < run.rows(); ++i) {
    if (run.radius[i] > 0.0) continue;
    throw InputError(fmt::format("{}: row {}: a radius of {} mm; it must be above 0",
                                 recording.name, run.points.rows[i] + 1,
                                 run.radius[i] / settings::kMillimetre));
  }
  run.pass = IntegersAt(recording, "pass", run.points.rows);
  run.times_known = recording.KnowsTimes();
  run.feed_known = recording.Find("feed_mm_min").has_value();
  run.time = TimesOf(recording, run);
  run.ballbar = recording.HeaderText("mounting.ballbar").value_or("");
  run.states_noise = recording.HeaderNumber(kNoiseKey).has_value();
  run.sd = noise > 0.0 ? noise : NoiseOf(recording, run);
  run.length_sd = settings::kMicrometre * recording.HeaderNumber("u_length_um", 0.0).value_or(0.0);
  run = With(run, UnderWay(run));
  if (run.rows() > 0) return run;
  throw InputError(recording.name + ": no pass in which the axes move; a ballbar measures circles");
}

BallbarRun Thinned(const BallbarRun& run, Index most) {
  if (run.rows() <= most) return run;
  const Index step = (run.rows() + most - 1) / most;
  std::vector<Index> kept;
  for (Index row = 0; row < run.rows(); row += step) kept.push_back(row);
  return With(run, kept);
}

}  // namespace abbe::simulation
