#include "diagnosis/campaign.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/arm_in_campaign.h"
#include "diagnosis/reference_in_campaign.h"
#include "diagnosis/shaft_in_campaign.h"
#include "failure/failure.h"
#include "recording/made_on.h"
#include "simulation/arm/arm_run.h"
#include "simulation/linkage/linkage_on_machine.h"
#include "simulation/points/length_simulation.h"
#include "simulation/points/plate_simulation.h"
#include "simulation/points/reference_trace.h"
#include "simulation/sweep/sweep_simulation.h"
#include "simulation/sweep/target_spots.h"

namespace abbe::diagnosis {

namespace {

// No dwell of a head has an angle of a shaft.
std::string KindOf(const recording::Recording& recording) {
  std::string kind = recording.Kind();
  const bool turns = recording.Find("shaft_deg") || recording.Find("shaft_rad");
  return kind == "dwell" && turns ? "shaft" : kind;
}

// The slope of a Gaussian process: its deviation over its length (fusion/machine_prior.h).
Eigen::Matrix<double, 6, 3> SlopesOf(const machine::Population& population) {
  Eigen::Matrix<double, 6, 3> slopes;
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      slopes(motion, axis) =
          fusion::PopulationDeviation(population, axis, motion) / population.smoothness;
    }
    slopes(axis, axis) = std::hypot(slopes(axis, axis), population.scale);
  }
  return slopes;
}

machine::VolumetricModel ModelOf(const Setup& setup) {
  if (setup.HasAxes()) return fusion::UnknownMachine(setup.machine);
  return {setup.machine.chain, setup.machine.travels};
}

const relm::LinkageSettings& LinkageOf(const Setup& setup, const std::string& recording) {
  if (setup.linkage) return *setup.linkage;
  throw InputError(fmt::format(
      "{}: the machine file has no table [linkage]; add it or leave the run out", recording));
}

}  // namespace

bool Setup::HasAxes() const {
  return std::any_of(machine.travels.begin(), machine.travels.end(),
                     [](const auto& travel) { return travel.last > travel.first; });
}

Campaign::Campaign(Setup setup, std::optional<simulation::Origin> origin)
    : setup_(std::move(setup)),
      model_(ModelOf(setup_)),
      prior_(setup_.machine, model_, setup_.machine.population.smoothness),
      origin_(std::move(origin)),
      notes_(setup_.notes) {}

void Campaign::Add(recording::Recording recording) {
  const machine::Machine& mill = setup_.machine;
  recording::RefuseOtherMachine(recording, mill.name);
  const std::string kind = KindOf(recording);
  const bool is_arm = simulation::IsArm(recording);
  if (!is_arm && kind != "shaft" && !setup_.HasAxes()) {
    throw InputError(fmt::format(
        "{}: the machine file has no axes (chain, [axis.X], [axis.Y], [axis.Z]); without them only "
        "a turning shaft (kind shaft) and an arm before an instrument can be diagnosed: kind "
        "linkage, with ref_x_mm, ref_y_mm, ref_z_mm and no x_mm, y_mm, z_mm",
        recording.name));
  }
  // An arm may well stand with a pivot that shows one value, and its poses are no neighbours.
  std::vector<BadData> bad = is_arm ? std::vector<BadData>{} : FlagBadRows(recording);
  if (kind == "sweep" || kind == "dwell" || kind == "gap-steps") {
    if (!setup_.head) {
      throw InputError(fmt::format(
          "{}: the machine file has no table [head]; add it or leave the run out", recording.name));
    }
    const simulation::SweepRun run =
        kind == "sweep" ? simulation::ReadSweepDwells(recording, *setup_.head, setup_.noise)
        : kind == "dwell"
            ? simulation::ReadStillReadings(recording, setup_.noise)
            : simulation::ReadGapSteps(recording, setup_.noise, SlopesOf(mill.population));
    runs_.push_back(
        {simulation::SimulateSweep(model_, mill.reference, {*setup_.head, setup_.target}, run),
         simulation::TraceOf(recording, run)});
    runs_.back().trace.spots = simulation::SpotsOnTarget(mill.chain, *setup_.head, run);
  } else if (is_arm) {
    LinkageOf(setup_, recording.name);
    runs_.push_back(MakeArmRun(recording, setup_, notes_, bad));
  } else if (kind == "linkage") {
    const relm::LinkageSettings& settings = LinkageOf(setup_, recording.name);
    const simulation::LinkageSimulation linkage(
        mill.chain, settings, relm::MakeLinkageModel(settings, relm::ErrorModel::kComplete));
    const auto run = AtMost(
        simulation::MeansOfStays(simulation::ReadLinkageRun(recording, settings)), kMostPoses);
    runs_.push_back({simulation::SimulateLinkage(model_, mill.reference, linkage, run),
                     simulation::TraceOf(recording, run, linkage)});
  } else if (kind == "length") {
    runs_.push_back({simulation::SimulateLengths(model_, mill.reference, recording),
                     simulation::TraceOf(recording, simulation::ReadMachinePoints(recording))});
  } else if (kind == "plate") {
    for (const auto& setup : simulation::ReadPlate(recording)) {
      runs_.push_back({simulation::SimulatePlate(model_, mill.reference, setup),
                       simulation::TraceOf(recording, setup.points)});
    }
  } else if (kind == "reference") {
    runs_.push_back(MakeReferenceRun(recording, setup_, model_, notes_));
  } else if (kind == "shaft") {
    runs_.push_back(MakeShaftRun(recording, setup_, notes_));
  } else {
    throw InputError(
        fmt::format("{}: kind is \"{}\"; diagnose takes sweep, dwell, gap-steps, linkage, "
                    "reference, length, plate and shaft",
                    recording.name, kind));
  }
  runs_.back().simulated.loss = estimation::RobustLoss::None();
  const bool of_points = kind == "reference" || kind == "length" || kind == "plate";
  if ((is_arm || of_points) && !recording.KnowsTimes()) {
    notes_.push_back(
        fmt::format("{}: knows the order of its readings, not their times; one reading counts as "
                    "one second, so what is told in s counts readings",
                    recording.name));
  }
  for (BadData& each : bad) bad_.push_back({simulation::StartedOf(recording), std::move(each)});
  const simulation::Origin start = origin();
  for (DiagnosedRun& run : runs_) {
    if (run.trace.rows() > 0) simulation::CountFrom(start, run.trace);
  }
}

simulation::Origin Campaign::origin() const {
  return origin_ ? *origin_ : simulation::OriginOf(scene().traces);
}

bool Campaign::HasArms() const {
  return std::any_of(runs_.begin(), runs_.end(),
                     [](const DiagnosedRun& run) { return run.arm.has_value(); });
}

bool Campaign::SetExcess(const std::vector<double>& excess, Change change) {
  constexpr double kMuchMore = 1.5, kLess = 0.95;
  bool changed = false;
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    DiagnosedRun& run = runs_[r];
    if (!run.arm) continue;
    const double ratio = excess[r] / run.excess;
    if (change == Change::kUp ? ratio < kMuchMore : ratio > kLess) continue;
    ArmBaseline& baseline = setup_.arms.at(run.simulated.name);
    baseline.excess = run.excess = excess[r];
    run.simulated = SimulatedArm(*run.arm, baseline);
    changed = true;
  }
  return changed;
}

std::vector<BadData> Campaign::bad_data() const {
  std::vector<BadData> all;
  const double start = origin().started;
  for (const auto& [started, found] : bad_) {
    BadData bad = found;
    bad.from += started - start;
    bad.to += started - start;
    const auto known = std::find_if(all.begin(), all.end(), [&](const BadData& other) {
      return other.cause == bad.cause && other.object == bad.object;
    });
    if (known == all.end()) {
      all.push_back(bad);
      continue;
    }
    known->from = std::min(known->from, bad.from);
    known->to = std::max(known->to, bad.to);
    known->count += bad.count;
  }
  return all;
}

simulation::Scene Campaign::scene() const {
  simulation::Scene scene;
  for (const DiagnosedRun& run : runs_) {
    if (run.trace.rows() > 0) scene.traces.push_back(&run.trace);
  }
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const auto& travel = setup_.machine.travels[static_cast<std::size_t>(axis)];
    scene.travel[axis] = travel.last - travel.first;
  }
  if (setup_.head) {
    scene.form = setup_.target.form;
    scene.form_length = setup_.target.form_length;
  }
  return scene;
}

}  // namespace abbe::diagnosis
