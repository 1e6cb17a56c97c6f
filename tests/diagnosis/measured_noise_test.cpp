// The noise of channels at rest, of tables whose noise is known.
#include "diagnosis/measured_noise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "random/counter_random.h"

namespace abbe::diagnosis {
namespace measured_noise_test {

using recording::Recording;

constexpr int kRows = 4000;

// Probe a drifts and has noise of `probe_nm`, b picks up ten times as much, the axis stands in
// every second of ten rows and then goes on by a millimetre.
Recording Dwell(double probe_nm) {
  const random::CounterRandom random(5, 1);
  Recording dwell;
  dwell.name = "dwell";
  dwell.header = "kind = \"gap-steps\"\n";
  dwell.columns = {{"time_s", {}}, {"x_mm", {}}, {"y_mm", {}}, {"z_mm", {}}};
  for (const char letter : {'a', 'b', 'c', 'd', 'e'}) {
    dwell.columns.push_back({std::string("probe_") + letter + "_um", {}});
  }
  for (int row = 0; row < kRows; ++row) {
    const int stay = row / 10;
    dwell.columns[0].values.push_back(0.05 * row);
    dwell.columns[1].values.push_back(stay);
    dwell.columns[2].values.push_back(0.0);
    dwell.columns[3].values.push_back(0.0);
    for (std::size_t probe = 0; probe < 5; ++probe) {
      const auto index = static_cast<std::uint64_t>(row) * 5 + probe;
      const double sd = (probe == 1 ? 10.0 : 1.0) * 1e-3 * probe_nm;
      // Every millimetre shifts the gap by a micrometre: no noise.
      dwell.columns[4 + probe].values.push_back(100.0 + stay + 1e-5 * row +
                                                sd * random.Normal(index));
    }
  }
  return dwell;
}

TEST(MeasuredNoise, IsThatOfTheStandstills) {
  const StillNoise noise = NoiseAtRest({Dwell(20.0)}, "probe_a_um");
  // Nine pairs a stay.
  EXPECT_NEAR(noise.freedom, 2.0 / 3.0 * 9.0 * kRows / 10, 1e-6);
  EXPECT_NEAR(noise.sd, 20e-9, 4.0 * 20e-9 / std::sqrt(2.0 * noise.freedom));
  EXPECT_EQ(NoiseAtRest({Dwell(20.0)}, "probe_f_um").freedom, 0.0);
}

TEST(MeasuredNoise, ReplacesWhatTheMachineFileStatesWhereThatIsWrong) {
  simulation::Instruments setup;
  setup.head.emplace();
  setup.noise.probe = 20e-9;
  UseMeasuredNoise({Dwell(20.0)}, setup);
  EXPECT_EQ(setup.noise.probe, 20e-9);
  EXPECT_TRUE(setup.notes.empty());
  UseMeasuredNoise({Dwell(40.0)}, setup);
  EXPECT_NEAR(setup.noise.probe, 40e-9, 2e-9);  // not that of the probe that picks something up
  EXPECT_THAT(setup.notes, testing::ElementsAre(testing::HasSubstr("where nothing moves (2400")));
}

}  // namespace measured_noise_test
}  // namespace abbe::diagnosis
