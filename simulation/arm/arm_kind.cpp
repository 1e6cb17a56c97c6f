// An arm before a reference instrument (arm_run.h).
//
// Noise of a pose: that of the encoders, of the instrument (ref_u_um or linkage.noise.reference_um)
// and of how the arm repeats (linkage.noise.repeatability_um). Where the instrument stands is found
// from the poses; runs with the same mounting.base in their header share it. Of several balls (header
// mounting.ball) the first is that of the machine file; the others stand anywhere on the hand. Poses far off what the
// arm's geometry makes of all others are left out as outliers (arm_baseline.h); the worst are noted
// with row and size. Failure: that of ReadLinkageRun and of FitArm.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "failure/failure.h"
#include "simulation/arm/arm_baseline.h"
#include "simulation/arm/arm_correction.h"
#include "simulation/arm/arm_run.h"
#include "simulation/kinds.h"
#include "simulation/linkage/linkage_kinds.h"
#include "simulation/linkage/linkage_trace.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using recording::Recording;

constexpr Index kFewest = 8;       // poses
constexpr std::size_t kNamed = 5;  // poses by their row

struct ArmFacts : RunFacts {
  ArmFacts(ArmBaseline of_run, std::string its_ball)
      : baseline(std::move(of_run)), ball(std::move(its_ball)) {}
  ArmBaseline baseline;
  std::string ball;  // header mounting.ball
};

constexpr const char* kBall = "mounting.ball";

// LinkageRun::ball: the first one is that of the machine file.
std::string BallIn(const Recording& recording, const FactsByRun& known) {
  const std::string ball = recording.HeaderText(kBall).value_or("");
  bool first = true;
  for (const auto& [name, facts] : known) {
    const auto* arm = dynamic_cast<const ArmFacts*>(facts.get());
    if (arm == nullptr) continue;
    if (name == recording.name || (!ball.empty() && arm->ball == ball)) return arm->baseline.ball;
    first = false;
  }
  return first ? "" : ball;
}

// The linkage with its base where another run with this one's mounting has it, or this run itself.
relm::LinkageSettings PlacedFor(const LinkageRun& run, const relm::LinkageSettings& settings,
                                const FactsByRun& known) {
  for (const auto& [name, facts] : known) {
    const auto* arm = dynamic_cast<const ArmFacts*>(facts.get());
    if (arm == nullptr || arm->baseline.mounting != run.mounting) continue;
    return HeldAtOnePlace(arm->baseline.settings, run);
  }
  return HeldAtOnePlace(Placed(settings, run), run);
}

std::string NoiseNote(const LinkageRun& kept, const ArmBaseline& baseline) {
  const double rms = GapsOf(kept, baseline).norm() / std::sqrt(kept.poses());
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
  std::vector<std::string> worst;
  for (std::size_t i = 0; i < std::min(kNamed, far.size()); ++i) {
    worst.push_back(fmt::format("row {} by {:.3g} mm", run.rows[far[i]] + 1, 1e3 * size[far[i]]));
  }
  const std::string more =
      far.size() > kNamed ? fmt::format(" and {} more", far.size() - kNamed) : "";
  return fmt::format("{}: {} of {} poses are left out, for they are off what fits the others: {}{}",
                     run.name, far.size(), run.poses(), fmt::join(worst, ", "), more);
}

InvalidReadings Outliers(const LinkageRun& run, const std::vector<Index>& far) {
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

class ArmRuns : public RunKind {
 public:
  std::string_view name() const override { return "arm"; }
  bool Takes(const Recording& head) const override { return IsArm(head); }
  bool NeedsAxes() const override { return false; }

  // An arm may well stand with a pivot that shows one value, and its poses are no neighbours.
  bool RowsFollowEachOther() const override { return false; }

  bool AsksForOthers() const override { return true; }
  PreparedRuns Prepare(const Recording& recording, const machine::VolumetricModel&,
                       const Instruments& on, const FactsByRun& known) const override {
    const relm::LinkageSettings& settings = on.LinkageFor(recording.name);
    LinkageRun run = ReadArmRun(recording, settings);
    run.ball = BallIn(recording, known);
    auto facts = FactsAs<ArmFacts>(known, run.name);
    const bool is_new = facts == nullptr;
    if (is_new && run.poses() < kFewest) {
      throw InputError(fmt::format("{}: has {} poses; an arm is diagnosed from {} on", run.name,
                                   run.poses(), kFewest));
    }
    if (is_new) {
      facts = std::make_shared<const ArmFacts>(FitArm(run, PlacedFor(run, settings, known)),
                                               recording.HeaderText(kBall).value_or(""));
    }
    PreparedRuns prepared;
    prepared.facts = facts;
    const ArmBaseline& baseline = facts->baseline;
    const std::vector<Index> far = FarOff(run, baseline);
    const LinkageRun kept = Without(run, far);
    if (is_new) prepared.notes.push_back(NoiseNote(kept, baseline));
    if (is_new && !far.empty()) prepared.notes.push_back(FarNote(run, baseline, far));
    if (!far.empty()) prepared.invalid.push_back(Outliers(run, far));
    if (recording.Find("time_s")) {
      NoteUnknownTimes(recording, prepared.notes);
    } else if (is_new) {
      prepared.notes.push_back(fmt::format(
          "{}: knows neither the times nor the order of its poses: a drift cannot be seen, and what "
          "there is of it counts as noise",
          run.name));
    }
    const LinkageSimulation arm = ArmSimulation(baseline.settings);
    const auto simulated = [arm, kept, x = baseline.x](double excess) {
      return SimulateArm(arm, kept, x, excess);
    };
    prepared.runs.push_back(
        {simulated(baseline.excess), ArmTraceOf(recording, kept, arm), baseline.excess, simulated});
    return prepared;
  }

  void RefuseStrangers(const std::vector<RunSource>& sources,
                       const Instruments& on) const override {
    if (!on.linkage) return;
    std::map<std::string, std::vector<RunSource>> balls;
    for (const RunSource& source : sources) {
      balls[source.head.HeaderText(kBall).value_or("")].push_back(source);
    }
    if (balls.size() > 1 && balls.contains("")) {
      throw InputError(fmt::format(
          "{}: header: does not state {}, as {} does; name the ball of each",
          balls.at("").front().head.name, kBall, balls.rbegin()->second.front().head.name));
    }
    for (const auto& [ball, of_ball] : balls) {
      RefuseOtherBalls(of_ball, *on.linkage, "name the ball of each in its header, mounting.ball");
    }
  }

  Correction Correct(const Recording& recording, const std::vector<ModelledCause>& causes,
                     const Origin& origin, const Instruments& on) const override {
    return CorrectArm(recording, causes, origin, on.LinkageFor(recording.name));
  }

  // Its poses are measured one by one.
  RowRule HeldOut(const Recording&) const override {
    constexpr std::size_t kFourth = 4;
    return [](std::size_t row) { return row % kFourth == 0; };
  }

  Recording Plan(Recording path, const Instruments&) const override {
    throw InputError(fmt::format(
        "{}: has no axis positions x_mm, y_mm, z_mm: the poses of an arm cannot be planned with",
        path.name));
  }
};

}  // namespace

const RunKind& ArmKind() {
  static const ArmRuns kind;
  return kind;
}

}  // namespace abbe::simulation
