// A measuring campaign on the rig, reduced so that it takes a second: sweeps of the three axes with
// few stations, the linkage on a grid over nearly the whole volume, one interferometer line.
#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <vector>

#include "../folders.h"
#include "fusion/fuse.h"
#include "hal/device_settings.h"
#include "machine/machine.h"
#include "probes/head_settings.h"
#include "relm/linkage_settings.h"
#include "rig/record_course.h"
#include "rig/record_lengths.h"
#include "rig/record_sweep.h"
#include "settings/document.h"
#include "simulation/kinds.h"
#include "simulation/sweep/sweep_simulation.h"

namespace abbe::fusion {

// The demonstration machine with other values: "step_mm = 1.0" -> "step_mm = 5.0".
inline settings::Document CampaignMachine(
    const std::vector<std::pair<std::string, std::string>>& changes = {}) {
  std::ifstream file(DemoMillFile());
  std::string text{std::istreambuf_iterator<char>(file), {}};
  text = std::regex_replace(text, std::regex("step_mm = 1.0"), "step_mm = 4.0");
  text = std::regex_replace(text, std::regex("passes = 5"), "passes = 2");
  for (const auto& [from, to] : changes) text = std::regex_replace(text, std::regex(from), to);
  return settings::Document::Parse(text, "campaign.toml");
}

struct Campaign {
  Campaign(const settings::Document& document, std::uint64_t seed)
      : Campaign(document, document, seed) {}

  // A machine that is as `truth` says and believed to be as `document` says.
  Campaign(const settings::Document& truth, const settings::Document& document, std::uint64_t seed)
      : machine(machine::ReadMachine(document.Root())),
        reference(machine.reference),
        instrument{probes::ReadHeadSettings(document.Root()),
                   probes::ReadTargetSettings(document.Root())},
        noise(probes::ReadProbeNoise(document.Root())),
        linkage(relm::ReadLinkageSettings(document.Root())),
        model(UnknownMachine(machine)),
        channels(rig::ChannelsOf(hal::ReadDevices(document.Root().Child("devices")))),
        rig(rig::World(rig::ReadRigSettings(truth.Root()), seed),
            rig::Linkage(rig::ReadLinkage(truth.Root()), seed)) {}

  recording::Recording SweepRecording(char axis, std::uint64_t run = 1) const {
    const rig::RecordSweepOptions options{
        .rate = 50.0, .moving = false, .run = run, .mounting = "A"};
    auto recording = rig::RecordSweep(rig.world(), axis, channels, options);
    recording.name = fmt::format("sweep {}", axis);
    return recording;
  }

  // As abbe fuse simulates it.
  simulation::SimulatedRun Simulated(const recording::Recording& recording) const {
    return Simulated(recording, model);
  }
  simulation::SimulatedRun Simulated(const recording::Recording& recording,
                                     const machine::VolumetricModel& on) const {
    return simulation::SimulateForMap(simulation::SourceOf(recording), on,
                                      {machine, instrument.head, instrument.target, noise, linkage})
        .front();
  }
  // As abbe fuse does it, knots and all.
  FuseReport Fused(const std::vector<recording::Recording>& recordings) const {
    FuseOptions options;
    options.runs_on = [&](const machine::VolumetricModel& on) {
      std::vector<simulation::SimulatedRun> runs;
      for (const auto& each : recordings) runs.push_back(Simulated(each, on));
      return runs;
    };
    return Fuse(machine, options.runs_on(model), options);
  }

  simulation::SimulatedRun Sweep(const recording::Recording& recording) const {
    return Simulated(recording);
  }

  simulation::SimulatedRun Sweep(char axis, std::uint64_t run = 1) const {
    return Sweep(SweepRecording(axis, run));
  }

  recording::Recording LinkageRecording(int points = 6, std::uint64_t run = 1) const {
    const Eigen::Vector3d middle = Eigen::Vector3d::Constant(0.030);
    const Eigen::Vector3d size = Eigen::Vector3d::Constant(0.058);
    const auto course = rig::DwellCourse(
        rig::GridPlaces(middle, size, Eigen::Vector3i::Constant(points)), 0.1, 0.1, 1);
    return rig.Record(course, {.rate = 100.0, .run = run});
  }

  simulation::SimulatedRun Linkage(recording::Recording recording) const {
    recording.name = "linkage";
    return Simulated(recording);
  }
  simulation::SimulatedRun Linkage() const { return Linkage(LinkageRecording()); }

  recording::Recording LengthRecording(char axis) const {
    auto recording =
        rig::RecordLengths(rig, {.axis = axis, .at = Eigen::Vector3d::Constant(0.030)});
    recording.name = fmt::format("length {}", axis);
    return recording;
  }
  simulation::SimulatedRun Length(char axis) const { return Simulated(LengthRecording(axis)); }

  // What the machine really does at a position with a tool point p_TQ, in W.
  Eigen::Vector3d TrueError(const Eigen::Vector3d& axes,
                            const Eigen::Vector3d& p_TQ = Eigen::Vector3d::Zero()) const {
    const auto table = rig.world().PoseOfTarget(axes);
    const Eigen::Vector3d tool = rig.world().PoseOfHead(axes) * p_TQ;
    return table.rotation.transpose() * (tool - table.translation) - p_TQ -
           relm::NominalTip(machine.chain, axes);
  }

  machine::Machine machine;
  Eigen::Vector3d reference;
  simulation::SweepInstrument instrument;
  probes::ProbeNoise noise;
  relm::LinkageSettings linkage;
  machine::VolumetricModel model;
  std::vector<hal::Channel> channels;
  rig::LinkageRig rig;
};

}  // namespace abbe::fusion
