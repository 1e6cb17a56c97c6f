// The kinds of run of the head of five probes: the swept axis goes over its travel and back;
// nothing moves; at some stations the other axes step to and fro by a known way.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "estimation/readings_at_rest.h"
#include "probes/channel_order.h"
#include "probes/sweep_dwells.h"
#include "recording/good_rows.h"
#include "settings/toml_text.h"
#include "settings/unit.h"
#include "simulation/kinds.h"
#include "simulation/linkage/standing_linkage.h"
#include "simulation/planned_run.h"
#include "simulation/repeated_run.h"
#include "simulation/stays.h"
#include "simulation/sweep/sweep_correction.h"
#include "simulation/sweep/sweep_run.h"
#include "simulation/sweep/sweep_simulation.h"
#include "simulation/sweep/sweep_trace.h"
#include "simulation/sweep/target_spots.h"

namespace abbe::simulation {
namespace {

using Eigen::Vector3d;
using recording::Recording;

constexpr const char* kAnew = "planned anew";  // a mounting
constexpr const char* kFirstMounting = "first";
constexpr double kLeastNoise = 1e-12;  // m

// The slope of a Gaussian process: its deviation over its length (fusion/machine_prior.h).
Eigen::Matrix<double, 6, 3> SlopesOf(const machine::Population& population) {
  Eigen::Matrix<double, 6, 3> slopes;
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      slopes(motion, axis) =
          machine::PopulationDeviation(population, axis, motion) / population.smoothness;
    }
    slopes(axis, axis) = std::hypot(slopes(axis, axis), population.scale);
  }
  return slopes;
}

// The name of the mounting; of a run without one its own name.
std::string MountingIdOf(const Recording& run) {
  if (auto id = run.HeaderText("mounting.id")) return *std::move(id);
  return run.HeaderText("mounting").value_or(run.name);
}

std::string MountingLines(const std::string& id, const SweepMounting& mounted) {
  return fmt::format("id = {}\nhead = {}\ntarget_shift_mm = {}\ntarget_reversed = {}\n",
                     settings::Quoted(id),
                     settings::Quoted(mounted.head_turned ? "180deg" : "0deg"),
                     mounted.target_shift / settings::kMillimetre, mounted.target_reversed);
}

recording::Blocks BlocksInProbeOrder(recording::Blocks blocks, const probes::ChannelOrder& order) {
  return [blocks = std::move(blocks), order](const auto& use) {
    blocks([&](const Recording& block) { use(probes::InProbeOrder(block, order)); });
  };
}

// Whether exchanged channels would make no difference.
bool NoiseIsOne(const SweepRun& run) {
  constexpr double kHardly = 1.1;  // of the variance
  double least = std::numeric_limits<double>::infinity(), most = 0.0;
  for (const Eigen::MatrixXd& covariance : run.covariance) {
    least = std::min(least, covariance.diagonal().mean());
    most = std::max(most, covariance.diagonal().mean());
  }
  return most < kHardly * least;
}

// The noise of the readings of a sweep while it stands, and whether a line in time is among them.
struct InStays {
  probes::ProbeNoise noise;
  bool has_line = false;
};

InStays NoiseInStays(const Recording& recording, const Stays& stays, probes::ProbeNoise noise) {
  InStays found{noise};
  for (std::size_t probe = 0; probe < probes::kProbes; ++probe) {
    const auto rest = estimation::NoiseAtRest(
        ReadingsIn(recording, fmt::format("probe_{:c}_um", 'a' + probe), stays));
    found.has_line = found.has_line || rest.kind == estimation::RestKind::kLine;
    if (rest.freedom > 0.0) found.noise.measured[probe] = rest.sd;
    if (rest.kind != estimation::RestKind::kMemory) continue;
    found.noise.measured[probe] = std::max(rest.memory.white, kLeastNoise);
    found.noise.memory[probe] = rest.memory.slow;
    found.noise.memory_time[probe] = rest.memory.time;
  }
  return found;
}

// The common part of the kinds.
class HeadKind : public RunKind {
 public:
  bool Takes(const Recording& head) const override { return head.Kind() == name(); }

  std::string_view Instrument() const override { return "head"; }
  // The axis, the set-up, the channels.
  std::string MountingOf(const Recording& head) const override {
    return fmt::format("{} {} {}", head.HeaderText("axis").value_or(""),
                       head.HeaderText("mounting.id").value_or(kFirstMounting),
                       head.HeaderText("mounting.swapped").value_or(""));
  }

  PreparedRuns Prepare(const Recording& recording, const machine::VolumetricModel& model,
                       const Instruments& on, const FactsByRun&) const override {
    on.HeadFor(recording.name);
    const probes::ChannelOrder order = probes::ChannelOrderOf(recording);
    if (order == probes::kAsNamed) return PrepareAll(recording, model, on);
    Instruments of_channels = on;
    of_channels.noise = probes::InProbeOrder(on.noise, order);
    return PrepareAll(probes::InProbeOrder(recording, order), model, of_channels);
  }

  Recording Plan(Recording path, const Instruments& on) const override {
    FlagPlaces(path);
    const probes::HeadSettings& head = on.HeadFor(path.name);
    for (std::size_t probe = 0; probe < probes::kProbes; ++probe) {
      const double middle = 0.5 * head.probes[probe].range;
      auto& gap = ColumnIn(path, fmt::format("probe_{:c}_um", 'a' + probe));
      for (std::size_t row = 0; row < gap.size(); ++row) {
        gap[row] = (middle + MixedSign(row, probe) * on.noise.probe) / settings::kMicrometre;
      }
    }
    return path;
  }

 protected:
  // On a machine with a head.
  virtual std::vector<SweepRun> Read(const Recording& recording, const Instruments& on) const = 0;

 private:
  // In the order of the probes.
  PreparedRuns PrepareAll(const Recording& recording, const machine::VolumetricModel& model,
                          const Instruments& on) const {
    PreparedRuns prepared;
    for (const SweepRun& run : Read(recording, on)) {
      prepared.runs.push_back(PrepareOne(recording, model, on, run));
    }
    return prepared;
  }

  static PreparedRun PrepareOne(const Recording& recording, const machine::VolumetricModel& model,
                                const Instruments& on, const SweepRun& run) {
    const SweepInstrument instrument{*on.head, on.target};
    PreparedRun prepared{SimulateSweep(model, on.machine.reference, instrument, run),
                         TraceOf(recording, run)};
    prepared.trace.head->spots = SpotsOnTarget(on.machine.chain, *on.head, run);
    if (NoiseIsOne(run)) return prepared;
    prepared.simulated.noise_exchanged = [=, reference = on.machine.reference](std::size_t one,
                                                                               std::size_t other) {
      SweepRun exchanged = run;
      std::swap(exchanged.covariance[one], exchanged.covariance[other]);
      return SimulateSweep(model, reference, instrument, exchanged);
    };
    return prepared;
  }
};

// The runs that could follow the first sweep of an axis.
class AfterSweep {
 public:
  AfterSweep(char axis, const Recording& sweep, const Instruments& on, const PathAbout& about)
      : axis_(axis), sweep_(sweep), on_(on), about_(about), name_(ShortName(sweep)) {}

  void Add(std::vector<NextRun>& runs, bool is_first) const {
    const double tilt = std::min(500e-6, 0.25 * on_.head->probes[0].range / Length());
    runs.push_back({fmt::format("mount the target anew, tilted by {:.0f} urad, and repeat {}",
                                tilt / settings::kMicro, name_),
                    Again({}),
                    {},
                    [tilt](SimulatedRun& run) { TiltTarget(tilt, run); }});
    constexpr double kShift = 10e-3;  // m
    runs.push_back({fmt::format("shift the target by {:.0f} mm along the axis and repeat {}",
                                kShift / settings::kMillimetre, name_),
                    Again({.target_shift = kShift})});
    runs.push_back({fmt::format("turn the target round by half a turn and repeat {}", name_),
                    Again({.target_reversed = true})});
    runs.push_back(
        {fmt::format("turn the head by half a turn about its normal and repeat {}", name_),
         Again({.head_turned = true})});
    const AgainAbout as_it_was{about_.machine, about_.started,
                               MountingLines(MountingIdOf(sweep_), MountedOf(sweep_))};
    runs.push_back({fmt::format("repeat {} in the reverse order, from the other end", name_),
                    TurnedRound(simulation::Again(sweep_, as_it_was))});
    runs.push_back(
        {fmt::format("repeat {} an hour later, the machine {:.0f} K warmer", name_, kWarmer),
         AnHourLater(sweep_, as_it_was)});
    if (is_first) AddSwapped(runs);
    AddBeside(runs, is_first);
  }

 private:
  static void TiltTarget(double tilt, SimulatedRun& run) {
    for (auto& block : run.blocks) {
      if (!block.name.starts_with("target_tilt")) continue;
      for (auto& entry : block.entries) entry.value = tilt;
    }
  }

  Recording Again(const SweepMounting& mounted) const {
    return simulation::Again(sweep_,
                             {about_.machine, about_.started, MountingLines(kAnew, mounted)});
  }

  // Everything but the cables as it was. Two probes of one unit see nearly the same.
  void AddSwapped(std::vector<NextRun>& runs) const {
    if (MountedOf(sweep_).channels != probes::kAsNamed) return;
    for (const auto& pair :
         {"probe_a+probe_b", "probe_a+probe_c", "probe_b+probe_c", "probe_d+probe_e"}) {
      runs.push_back(
          {fmt::format("swap the cables of {} at the amplifier and repeat {}", pair, name_),
           simulation::Again(sweep_, {about_.machine, about_.started,
                                      MountingLines(MountingIdOf(sweep_), MountedOf(sweep_)) +
                                          fmt::format("swapped = \"{}\"\n", pair)})});
    }
  }

  const machine::Travel& TravelOf(char axis) const { return on_.machine.travels[axis - 'X']; }
  double Length() const { return TravelOf(axis_).last - TravelOf(axis_).first; }

  // With the head where the sweep has it.
  void AddBeside(std::vector<NextRun>& runs, bool is_first) const {
    const auto rows = recording::GoodRows(sweep_);
    Vector3d first, last;  // of the sweep; its rows may leave the travel by their window
    for (const char each : {'X', 'Y', 'Z'}) {
      const int k = each - 'X';
      const auto position = recording::ValuesOf(sweep_, fmt::format("{}_mm", "xyz"[k]), rows);
      const auto [least, most] = std::minmax_element(position.begin(), position.end());
      const auto& travel = TravelOf(each);
      first[k] = std::clamp(each == axis_ ? *least : position.front(), travel.first, travel.last);
      last[k] = std::clamp(*most, travel.first, travel.last);
    }
    const int swept = axis_ - 'X';
    runs.push_back(
        {fmt::format("record gap steps beside {}: at three stations of {} the other axes step by "
                     "45 um to and fro",
                     name_, axis_),
         GapStepPath(axis_, first,
                     {first[swept], std::midpoint(first[swept], last[swept]), last[swept]},
                     about_)});
    if (!is_first) return;
    runs.push_back({"hold still for some seconds where the sweep begins, and record the probes",
                    StillPath(axis_, first, about_)});
  }

  char axis_;
  const Recording& sweep_;
  const Instruments& on_;
  const PathAbout& about_;
  std::string name_;
};

class SweepRuns : public HeadKind {
 public:
  std::string_view name() const override { return "sweep"; }

  bool MakesMaps() const override { return true; }
  std::vector<SimulatedRun> ForMap(const RunSource& source, const machine::VolumetricModel& model,
                                   const Instruments& on) const override {
    const probes::HeadSettings& head = on.HeadFor(source.head.name);
    const probes::ChannelOrder order = probes::ChannelOrderOf(source.head);
    const recording::Blocks blocks =
        order == probes::kAsNamed ? source.blocks : BlocksInProbeOrder(source.blocks, order);
    return {SimulateSweep(
        model, on.machine.reference, {head, on.target},
        ReadSweepRun(source.head, blocks, head, probes::InProbeOrder(on.noise, order)))};
  }

  Stays StaysIn(const Recording& recording) const override {
    return SettledStays(recording, probes::DwellRuleOf(recording).settle);
  }
  // The means of its stations have their scatter from the sweep itself.
  bool ShowsNoiseAtRest() const override { return false; }

  Correction Correct(const Recording& recording, const std::vector<ModelledCause>& causes,
                     const Origin& origin, const Instruments& on) const override {
    const probes::ChannelOrder order = probes::ChannelOrderOf(recording);
    Correction corrected = CorrectSweep(probes::InProbeOrder(recording, order), causes, origin, on);
    corrected.recording = probes::InProbeOrder(std::move(corrected.recording), order);
    return corrected;
  }

  RowRule HeldOut(const Recording& recording) const override { return EverySecondPass(recording); }

  // A sweep of each axis over its travel, there and back.
  std::vector<NextRun> FirstRuns(const Instruments& on, const PathAbout& about) const override {
    std::vector<NextRun> runs;
    if (!on.head) return runs;
    for (const char axis : {'X', 'Y', 'Z'}) {
      const machine::Travel& travel = on.machine.travels[axis - 'X'];
      if (travel.first == travel.last) continue;
      runs.push_back(
          {fmt::format("sweep {} over its travel, there and back, with the head", axis),
           SweepPath(axis, on.machine.travels, MountingLines(kFirstMounting, {}), about)});
    }
    return runs;
  }

  // After the first sweep of each axis.
  std::vector<NextRun> NextRuns(const std::vector<const Recording*>& recorded,
                                const Instruments& on, const PathAbout& about) const override {
    std::map<char, const Recording*> sweeps;
    for (const Recording* each : recorded) {
      sweeps.emplace(each->HeaderText("axis").value_or("X")[0], each);
    }
    std::vector<NextRun> runs;
    for (const auto& [axis, sweep] : sweeps) {
      AfterSweep(axis, *sweep, on, about).Add(runs, axis == sweeps.begin()->first);
    }
    return runs;
  }

 protected:
  // With a line in time in what the stays hold, their readings too.
  std::vector<SweepRun> Read(const Recording& recording, const Instruments& on) const override {
    std::vector<SweepRun> runs{ReadSweepDwells(recording, *on.head, on.noise)};
    const Stays stays = StaysIn(recording);
    const InStays found = NoiseInStays(recording, stays, on.noise);
    if (found.has_line) runs.push_back(ReadReadingsInStays(recording, stays, found.noise));
    return runs;
  }
};

class DwellRuns : public HeadKind {
 public:
  std::string_view name() const override { return "dwell"; }
  bool Stands() const override { return true; }

  // Runs of what it shows: the probes, the encoders or both.
  PreparedRuns Prepare(const Recording& recording, const machine::VolumetricModel& model,
                       const Instruments& on, const FactsByRun& known) const override {
    auto encoders = StandingLinkage(recording, model, on);
    PreparedRuns prepared;
    if (!encoders || recording.Find("probe_a_um")) {
      prepared = HeadKind::Prepare(recording, model, on, known);
    }
    if (encoders) {
      prepared.runs.push_back(*std::move(encoders));
    } else if (recording.Find("pivot_1_rad")) {
      prepared.notes.push_back(recording.name +
                               ": its encoders are not used; that takes [linkage] in the machine "
                               "file, all its pivots, and axes that stand");
    }
    return prepared;
  }

  Recording Plan(Recording path, const Instruments& on) const override {
    if (!path.Find("pivot_1_rad") || !on.linkage) return HeadKind::Plan(std::move(path), on);
    if (path.Find("probe_a_um")) {
      path = HeadKind::Plan(std::move(path), on);
    } else {
      FlagPlaces(path);
    }
    PlanAngles(on, path);
    return path;
  }

 protected:
  std::vector<SweepRun> Read(const Recording& recording, const Instruments& on) const override {
    return {ReadStillReadings(recording, on.noise)};
  }
};

class GapStepsRuns : public HeadKind {
 public:
  std::string_view name() const override { return "gap-steps"; }

 protected:
  std::vector<SweepRun> Read(const Recording& recording, const Instruments& on) const override {
    return {ReadGapSteps(recording, on.noise, SlopesOf(on.machine.population))};
  }
};

}  // namespace

const RunKind& SweepKind() {
  static const SweepRuns kind;
  return kind;
}

const RunKind& DwellKind() {
  static const DwellRuns kind;
  return kind;
}

const RunKind& GapStepsKind() {
  static const GapStepsRuns kind;
  return kind;
}

}  // namespace abbe::simulation
