// Seconds of an update of a map that is kept true, by one sweep of the demonstration machine: with
// the form of the target in the state, and as noise of the sweep. In turns, the median of each.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "fusion/fuse.h"
#include "hal/device_settings.h"
#include "machine/drift.h"
#include "rig/record_sweep.h"
#include "settings/document.h"
#include "simulation/kinds.h"
#include "track/tracked_map.h"

namespace {

using namespace abbe;

constexpr int kUpdates = 15;
constexpr double kMeasured = 1.79e9, kDay = 86400.0;  // s

settings::Document WithDrift() {
  std::ifstream file(ABBE_SOURCE_DIR "/machines/demo_mill.toml");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  return settings::Document::Parse(
      text + "\n[drift]\nstraightness_um = 0.05\nroll_urad = 1.0\npitch_urad = 1.0\n",
      "demo_mill.toml");
}

class Updates {
 public:
  explicit Updates(const settings::Document& document)
      : machine_(machine::ReadMachine(document.Root())),
        drift_(machine::ReadDrift(document.Root())),
        model_(fusion::UnknownMachine(machine_)),
        instruments_{machine_, probes::ReadHeadSettings(document.Root()),
                     probes::ReadTargetSettings(document.Root()),
                     probes::ReadProbeNoise(document.Root()),
                     relm::ReadLinkageSettings(document.Root())},
        world_(rig::ReadRigSettings(document.Root()), 1),
        channels_(rig::ChannelsOf(hal::ReadDevices(document.Root().Child("devices")))) {}

  std::vector<simulation::SimulatedRun> Sweeps(const std::string& axes, bool form_is_noise) const {
    std::vector<simulation::SimulatedRun> runs;
    for (const char axis : axes) {
      const auto sweep = rig::RecordSweep(world_, axis, channels_, {.rate = 50.0, .mounting = "A"});
      runs.push_back(
          simulation::SimulateForMap(simulation::SourceOf(sweep), model_, instruments_).front());
      if (form_is_noise) runs.back().form_apart = nullptr;
    }
    return runs;
  }
  track::TrackedMap Begin(bool form_is_noise) const {
    const auto fused = fusion::Fuse(machine_, Sweeps("XYZ", form_is_noise),
                                    {.choose_smoothness = false, .measured = kMeasured});
    return {machine_, fused.map, drift_};
  }

 private:
  machine::Machine machine_;
  machine::Drift drift_;
  machine::VolumetricModel model_;
  simulation::Instruments instruments_;
  rig::World world_;
  std::vector<hal::Channel> channels_;
};

double SecondsOf(track::TrackedMap map, const std::vector<simulation::SimulatedRun>& runs) {
  map.Follow({.time = kMeasured + kDay});
  const auto start = std::chrono::steady_clock::now();
  map.Take(runs, kMeasured + kDay);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double Median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

}  // namespace

int main() {
  const Updates updates(WithDrift());
  const track::TrackedMap maps[] = {updates.Begin(true), updates.Begin(false)};
  const std::vector<simulation::SimulatedRun> runs[] = {updates.Sweeps("X", true),
                                                        updates.Sweeps("X", false)};
  std::vector<double> seconds[2];
  for (int update = 0; update < kUpdates; ++update) {
    for (int k = 0; k < 2; ++k) seconds[k].push_back(SecondsOf(maps[k], runs[k]));
  }
  const char* const names[] = {"form as noise", "form in the state"};
  fmt::print("{:<20}{:>10}{:>12}\n", "", "numbers", "s");
  for (int k = 0; k < 2; ++k) {
    fmt::print("{:<20}{:>10}{:>12.4f}\n", names[k], maps[k].names().size(), Median(seconds[k]));
  }
  fmt::print("ratio {:.2f}\n", Median(seconds[1]) / Median(seconds[0]));
  return EXIT_SUCCESS;
}
