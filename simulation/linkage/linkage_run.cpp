#include "simulation/linkage/linkage_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "failure/failure.h"
#include "recording/good_rows.h"
#include "relm/tip_path.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;

constexpr std::array<const char*, 3> kCommanded{"x_mm", "y_mm", "z_mm"};
constexpr std::array<const char*, 3> kReference{"ref_x_mm", "ref_y_mm", "ref_z_mm"};
constexpr const char* kStated = "ref_u_um";

void RefuseOtherKinds(const recording::Recording& recording) {
  const std::string kind = recording.Kind();
  if (kind == "linkage" || kind == "reference" || kind == "dwell") return;
  throw InputError(fmt::format(
      "{}: kind is \"{}\"; the linkage needs recordings of kind linkage, with the columns "
      "pivot_1_rad ... and the axis positions",
      recording.name, kind));
}

Eigen::VectorXd Take(const recording::Recording& recording, const std::string& name,
                     const std::vector<std::size_t>& rows) {
  const std::vector<double> values = recording::ValuesOf(recording, name, rows);
  return Eigen::Map<const Eigen::VectorXd>(values.data(), values.size());
}

// Where a new stay begins; the last one is the number of poses.
std::vector<Index> StartsOfStays(const LinkageRun& run, double window) {
  std::vector<Index> starts{0};
  for (Index pose = 1; pose < run.poses(); ++pose) {
    const auto moved = run.commanded.col(pose) - run.commanded.col(starts.back());
    if (moved.cwiseAbs().maxCoeff() > window) starts.push_back(pose);
  }
  starts.push_back(run.poses());
  return starts;
}

void Resize(LinkageRun& run, Index joints, Index poses, bool warmth) {
  run.rows.resize(poses);
  run.time.resize(poses);
  run.commanded.resize(3, poses);
  run.reference.resize(3, poses);
  run.reference_sd.resize(3, poses);
  run.samples.resize(poses);
  run.readings.angles.resize(joints, poses);
  run.readings.warmth.resize(warmth ? poses : 0);
}

}  // namespace

LinkageRun ReadLinkageRun(const recording::Recording& recording,
                          const relm::LinkageSettings& settings) {
  RefuseOtherKinds(recording);
  relm::GoodReadings good = relm::ReadAngles(recording, settings);
  LinkageRun run;
  run.name = recording.name;
  run.mounting = recording.HeaderText("mounting.base").value_or("");
  run.one_by_one = !recording.KnowsTimes();
  Resize(run, good.readings.angles.rows(), good.readings.poses(), good.readings.warmth.size() > 0);
  run.readings = std::move(good.readings);
  run.rows = std::move(good.rows);
  const auto time = recording.Find("time_s");
  run.time = time ? Take(recording, "time_s", run.rows)
                  : Eigen::VectorXd::LinSpaced(run.poses(), 0.0, run.poses() - 1.0);
  run.samples.setOnes();
  const auto stated = recording.Find(kStated);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto commanded = recording.Find(kCommanded[axis]);
    const auto reference = recording.Find(kReference[axis]);
    if (!commanded && !reference) {
      throw InputError(fmt::format(
          "{}: has neither {} nor {}: without a reference position the linkage cannot be "
          "calibrated; record the axis positions with it",
          recording.name, kCommanded[axis], kReference[axis]));
    }
    run.referenced[axis] = reference.has_value();
    run.commanded.row(axis) =
        Take(recording, commanded ? kCommanded[axis] : kReference[axis], run.rows);
    run.reference.row(axis) = reference ? Take(recording, kReference[axis], run.rows)
                                        : Eigen::VectorXd(run.commanded.row(axis));
    run.reference_sd.row(axis).setConstant(reference ? settings.noise.reference
                                                     : settings.noise.machine);
    if (stated && reference) run.reference_sd.row(axis) = Take(recording, kStated, run.rows);
  }
  for (std::size_t& row : run.rows) row += recording.first_row;
  return run;
}

LinkageRun MeansOfStays(LinkageRun run, double window) {
  if (run.poses() == 0 || run.one_by_one) return run;
  const std::vector<Index> starts = StartsOfStays(run, window);
  if (std::ssize(starts) == run.poses() + 1) return run;  // it never stands
  LinkageRun means = Blank(run, starts.size() - 1);
  for (Index stay = 0; stay < means.poses(); ++stay) {
    const Index first = starts[stay];
    const Index count = starts[stay + 1] - first;
    const auto weights = run.samples.segment(first, count);
    const double total = weights.sum();
    means.rows[stay] = run.rows[first];
    means.time[stay] = run.time.segment(first, count).dot(weights) / total;
    means.commanded.col(stay) = run.commanded.middleCols(first, count) * weights / total;
    means.reference.col(stay) = run.reference.middleCols(first, count) * weights / total;
    means.reference_sd.col(stay) = run.reference_sd.middleCols(first, count) * weights / total;
    means.readings.angles.col(stay) =
        run.readings.angles.middleCols(first, count) * weights / total;
    if (run.readings.warmth.size() > 0) {
      means.readings.warmth[stay] = run.readings.warmth.segment(first, count).dot(weights) / total;
    }
    means.samples[stay] = total;
  }
  return means;
}

void CountIndependent(const relm::LinkageNoise& noise, const Eigen::VectorXd& duration,
                      LinkageRun& run) {
  if (noise.memory_share == 0.0) return;
  for (Index pose = 0; pose < run.poses(); ++pose) {
    const double n = run.samples[pose];
    if (n < 2.0 || !(duration[pose] > 0.0)) continue;
    const double kept = std::exp(-duration[pose] / (n - 1.0) / noise.memory_time);
    // The mean of kept^|i - k| over all pairs: a geometric sum.
    const double pairs = (1.0 + kept) / (1.0 - kept) / n -
                         2.0 * kept * (1.0 - std::pow(kept, n)) / std::pow(n * (1.0 - kept), 2);
    run.samples[pose] = 1.0 / ((1.0 - noise.memory_share) / n + noise.memory_share * pairs);
  }
}

LinkageRun RunAt(const Eigen::Matrix3Xd& positions, const relm::LinkageSettings& settings) {
  LinkageRun run;
  run.name = "planned";
  Resize(run, settings.chain.joints(), positions.cols(), false);
  run.time = Eigen::VectorXd::LinSpaced(run.poses(), 0.0, run.poses() - 1.0);
  run.commanded = positions;
  run.reference = positions;
  run.reference_sd.setConstant(settings.noise.reference);
  run.referenced.fill(true);
  run.readings.angles.setZero();
  run.samples.setOnes();
  for (std::size_t pose = 0; pose < run.rows.size(); ++pose) run.rows[pose] = pose;
  return run;
}

LinkageRun Selection(const LinkageRun& run, const std::vector<Index>& poses) {
  LinkageRun chosen = Blank(run, poses.size());
  for (Index i = 0; i < chosen.poses(); ++i) {
    const Index pose = poses[i];
    chosen.rows[i] = run.rows[pose];
    chosen.time[i] = run.time[pose];
    chosen.commanded.col(i) = run.commanded.col(pose);
    chosen.reference.col(i) = run.reference.col(pose);
    chosen.reference_sd.col(i) = run.reference_sd.col(pose);
    chosen.readings.angles.col(i) = run.readings.angles.col(pose);
    if (run.readings.warmth.size() > 0) chosen.readings.warmth[i] = run.readings.warmth[pose];
    chosen.samples[i] = run.samples[pose];
  }
  return chosen;
}

LinkageRun AtMost(const LinkageRun& run, Index most) {
  if (run.poses() <= most) return run;
  std::vector<Index> kept;
  const Index step = (run.poses() + most - 1) / most;
  for (Index pose = 0; pose < run.poses(); pose += step) kept.push_back(pose);
  return Selection(run, kept);
}

LinkageRun Joined(const LinkageRun& run, const LinkageRun& next) {
  LinkageRun both = Blank(run, run.poses() + next.poses());
  std::copy(run.rows.begin(), run.rows.end(), both.rows.begin());
  std::copy(next.rows.begin(), next.rows.end(), both.rows.begin() + run.rows.size());
  both.time << run.time, next.time;
  both.commanded << run.commanded, next.commanded;
  both.reference << run.reference, next.reference;
  both.reference_sd << run.reference_sd, next.reference_sd;
  both.readings.angles << run.readings.angles, next.readings.angles;
  if (both.readings.warmth.size() > 0) {
    both.readings.warmth << run.readings.warmth, next.readings.warmth;
  }
  both.samples << run.samples, next.samples;
  return both;
}

LinkageRun Blank(const LinkageRun& run, Index poses) {
  LinkageRun blank;
  blank.name = run.name;
  blank.mounting = run.mounting;
  blank.ball = run.ball;
  blank.referenced = run.referenced;
  blank.one_by_one = run.one_by_one;
  Resize(blank, run.readings.angles.rows(), poses, run.readings.warmth.size() > 0);
  return blank;
}

}  // namespace abbe::simulation
