#include "diagnosis/arm_in_campaign.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/arm_baseline.h"
#include "failure/failure.h"
#include "simulation/arm/arm_run.h"

namespace abbe::diagnosis {
namespace {

using Eigen::Index;
using simulation::LinkageRun;

constexpr Index kFewest = 8;      // poses
constexpr std::size_t kTold = 5;  // poses by their row

// The linkage with its base where another run with this one's mounting has it, or this run itself.
relm::LinkageSettings PlacedFor(const LinkageRun& run, const Setup& setup) {
  for (const auto& [name, arm] : setup.arms) {
    if (arm.mounting == run.mounting) return simulation::HeldAtOnePlace(arm.settings, run);
  }
  return simulation::HeldAtOnePlace(simulation::Placed(*setup.linkage, run), run);
}

std::string NoiseNote(const LinkageRun& kept, const ArmBaseline& baseline) {
  const double rms = GapsOf(kept, baseline).norm() / std::sqrt(static_cast<double>(kept.poses()));
  std::string note =
      fmt::format("{}: the arm as its geometry fits {} poses leaves {:.3g} mm rms in space",
                  kept.name, kept.poses(), 1e3 * rms);
  if (baseline.excess == 1.0) return note + ", as its stated noise would";
  return note +
         fmt::format(
             "; as neighbours share it, that counts as {:.3g} times its stated noise until a "
             "cause explains it",
             baseline.excess);
}

std::string FarNote(const LinkageRun& run, const ArmBaseline& baseline, std::vector<Index> far) {
  const Eigen::VectorXd size = GapsOf(run, baseline).colwise().norm();
  std::sort(far.begin(), far.end(), [&](Index a, Index b) { return size[a] > size[b]; });
  std::vector<std::string> told;
  for (std::size_t i = 0; i < std::min(kTold, far.size()); ++i) {
    told.push_back(fmt::format("row {} by {:.3g} mm",
                               run.rows[static_cast<std::size_t>(far[i])] + 1, 1e3 * size[far[i]]));
  }
  const std::string more =
      far.size() > kTold ? fmt::format(" and {} more", far.size() - kTold) : "";
  return fmt::format("{}: {} of {} poses are left out, for they are off what fits the others: {}{}",
                     run.name, far.size(), run.poses(), fmt::join(told, ", "), more);
}

BadData Outliers(const LinkageRun& run, const std::vector<Index>& far) {
  return {"outliers", "arm", run.time[far.front()], run.time[far.back()],
          static_cast<int>(far.size())};
}

LinkageRun Without(const LinkageRun& run, const std::vector<Index>& far) {
  std::vector<Index> kept;
  for (Index pose = 0; pose < run.poses(); ++pose) {
    if (!std::binary_search(far.begin(), far.end(), pose)) kept.push_back(pose);
  }
  return Selection(run, kept);
}

}  // namespace

simulation::SimulatedRun SimulatedArm(const LinkageRun& run, const ArmBaseline& baseline) {
  return simulation::SimulateArm(simulation::ArmSimulation(baseline.settings), run, baseline.x,
                                 baseline.excess);
}

DiagnosedRun MakeArmRun(const recording::Recording& recording, Setup& setup,
                        std::vector<std::string>& notes, std::vector<BadData>& bad) {
  LinkageRun run = simulation::AtMost(
      simulation::MeansOfStays(simulation::ReadLinkageRun(recording, *setup.linkage)), kMostPoses);
  const double again = setup.linkage->noise.repeatability;
  run.reference_sd = (run.reference_sd.array().square() + again * again).sqrt();
  if (run.poses() < kFewest && !setup.arms.contains(run.name)) {
    throw InputError(fmt::format("{}: has {} poses; an arm is diagnosed from {} on", run.name,
                                 run.poses(), kFewest));
  }
  const bool is_new = !setup.arms.contains(run.name);
  if (is_new) setup.arms.emplace(run.name, FitArm(run, PlacedFor(run, setup)));
  const ArmBaseline& baseline = setup.arms.at(run.name);
  const std::vector<Index> far = FarOff(run, baseline);
  const LinkageRun kept = Without(run, far);
  if (is_new) notes.push_back(NoiseNote(kept, baseline));
  if (is_new && !far.empty()) notes.push_back(FarNote(run, baseline, far));
  if (!far.empty()) bad.push_back(Outliers(run, far));
  const auto arm = simulation::ArmSimulation(baseline.settings);
  return {SimulatedArm(kept, baseline), simulation::ArmTraceOf(recording, kept, arm), kept,
          baseline.excess};
}

}  // namespace abbe::diagnosis
