// The reduction of a sweep of the virtual rig, whichever way its control counts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "probes/sweep_reduction.h"
#include "rig/record_sweep.h"
#include "tests/counted_machine.h"

namespace abbe::probes {
namespace counted_sweep_test {

double MeanOf(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

// EYX of the rig at the stations of a sweep, without its least-squares line.
std::vector<double> StraightnessOfRig(const rig::World& world,
                                      const std::vector<double>& stations) {
  std::vector<double> values;
  for (const double x : stations) values.push_back(world.ErrorsOf(0, x)[1]);
  const double middle = MeanOf(stations), mean = MeanOf(values);
  double product = 0.0, square = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    product += (stations[i] - middle) * (values[i] - mean);
    square += (stations[i] - middle) * (stations[i] - middle);
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] -= mean + product / square * (stations[i] - middle);
  }
  return values;
}

// The arm in the Abbe term of a straightness, and how far the target has gone under the probes,
// have a sign that only the count tells: read the other way, EYX and EZX are wrong by micrometres,
// far beyond U95.
TEST(CountedSweep, IsReducedRightWhicheverWayItCountsAndWrongWhenTheFileSaysTheOther) {
  double worst_wrong = 0.0;
  for (const bool as_tool : {false, true}) {
    const settings::Document document = tests::MachineOf("[w X Y b Z t]", as_tool);
    const rig::World world(rig::ReadRigSettings(document.Root()), 7);
    const auto channels = rig::ChannelsOf(hal::ReadDevices(document.Root().Child("devices")));
    const auto recording =
        rig::RecordSweep(world, 'X', channels, {.rate = 50.0, .moving = false, .run = 1});
    const SweepSetup right = ReadSweepSetup(document.Root());
    SweepSetup wrong = right;
    wrong.machine.chain = machine::Chain::Parse("[w X Y b Z t]");
    if (!as_tool) wrong.machine.chain.ReadPositive("tool", "");
    const auto result = ReduceSweep(recording, right);
    const auto mistaken = ReduceSweep(recording, wrong);
    EXPECT_EQ(result.positive, as_tool ? "tool" : "carriage");
    const auto truth = StraightnessOfRig(world, result.stations);
    for (std::size_t c = 0; c < result.components.size(); ++c) {
      if (result.components[c].component.name != "EYX") continue;
      for (std::size_t i = 0; i < truth.size(); ++i) {
        const auto at = static_cast<Eigen::Index>(i);
        EXPECT_LT(std::abs(result.components[c].value[at] - truth[i]),
                  4 * result.components[c].u[at]);
        worst_wrong = std::max(worst_wrong, std::abs(mistaken.components[c].value[at] - truth[i]) /
                                                mistaken.components[c].u[at]);
      }
    }
  }
  EXPECT_GT(worst_wrong, 10.0);
}

}  // namespace counted_sweep_test
}  // namespace abbe::probes
