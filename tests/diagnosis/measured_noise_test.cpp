// The noise of channels at rest, of tables whose noise is known.
#include "diagnosis/measured_noise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "random/counter_random.h"

namespace abbe::diagnosis {
namespace measured_noise_test {

using recording::Recording;

constexpr int kRows = 4000;
constexpr double kStep = 0.05;  // s

// What probe `probe` shows in a row beside its gap, um.
using Noise = std::function<double(std::size_t probe, int row)>;

// The axis stands in every second of ten rows and then goes on by a millimetre.
Recording Made(const std::string& kind, const Noise& noise) {
  Recording made;
  made.name = kind;
  made.header = "kind = \"" + kind + "\"\naxis = \"X\"\n";
  made.columns = {{"time_s", {}}, {"x_mm", {}}, {"y_mm", {}}, {"z_mm", {}}, {"pass", {}}};
  for (const char letter : {'a', 'b', 'c', 'd', 'e'}) {
    made.columns.push_back({std::string("probe_") + letter + "_um", {}});
  }
  for (int row = 0; row < kRows; ++row) {
    const int stay = row / 10;
    made.columns[0].values.push_back(kStep * row);
    made.columns[1].values.push_back(stay);
    made.columns[2].values.push_back(0.0);
    made.columns[3].values.push_back(0.0);
    made.columns[4].values.push_back(1.0);
    for (std::size_t probe = 0; probe < 5; ++probe) {
      // Every millimetre shifts the gap by a micrometre: no noise. A slow drift.
      made.columns[5 + probe].values.push_back(100.0 + stay + 1e-5 * row + noise(probe, row));
    }
  }
  return made;
}

double Normal(std::size_t probe, int row) {
  static const random::CounterRandom kRandom(5, 1);
  return kRandom.Normal(static_cast<std::uint64_t>(row) * 5 + probe);
}

// Probe b has ten times the noise of the others.
Recording GapSteps(double probe_nm) {
  return Made("gap-steps", [=](std::size_t probe, int row) {
    return (probe == 1 ? 10.0 : 1.0) * 1e-3 * probe_nm * Normal(probe, row);
  });
}

simulation::Instruments Stating(double probe_nm) {
  simulation::Instruments setup;
  setup.head.emplace();
  setup.noise.probe = 1e-9 * probe_nm;
  return setup;
}

TEST(MeasuredNoise, IsThatOfTheStandstills) {
  const auto noise = NoiseAtRest({GapSteps(20.0)}, "probe_a_um");
  EXPECT_EQ(noise.kind, estimation::RestKind::kWhite);
  // Nine pairs a stay.
  EXPECT_NEAR(noise.freedom, 2.0 / 3.0 * 9.0 * kRows / 10, 1e-6);
  EXPECT_NEAR(noise.sd, 20e-9, 4.0 * 20e-9 / std::sqrt(2.0 * noise.freedom));
  EXPECT_EQ(NoiseAtRest({GapSteps(20.0)}, "probe_f_um").freedom, 0.0);
}

TEST(MeasuredNoise, ReplacesWhatTheMachineFileStatesOfTheChannelsOfWhichThatIsWrong) {
  simulation::Instruments setup = Stating(20.0);
  UseMeasuredNoise({GapSteps(20.0)}, setup);
  EXPECT_EQ(setup.noise.Of(0), 20e-9);
  EXPECT_NEAR(setup.noise.Of(1), 200e-9, 10e-9);
  EXPECT_EQ(setup.noise.Of(2), 20e-9);
  EXPECT_THAT(setup.notes, testing::ElementsAre(testing::HasSubstr("probes: probe_b ")));
}

TEST(MeasuredNoise, NamesTheChannelThatScattersFarMoreThanIsStated) {
  for (const char* kind : {"gap-steps", "sweep"}) {
    simulation::Instruments setup = Stating(20.0);
    const auto noise = [](std::size_t probe, int row) {
      return (probe == 3 ? 0.2 : 0.05) * Normal(probe, row);
    };
    UseMeasuredNoise({Made(kind, noise)}, setup);
    ASSERT_EQ(setup.noisy.size(), 1u) << kind;
    EXPECT_EQ(setup.noisy[0].name, "probe_d");
    EXPECT_NEAR(setup.noisy[0].factor, 10.0, 0.5);
  }
}

TEST(MeasuredNoise, DoesNotTakeALineForNoise) {
  simulation::Instruments setup = Stating(20.0);
  const auto noise = [](std::size_t probe, int row) {
    const double mains = std::sin(2.0 * std::numbers::pi * 50.0 * 1.017 * kStep * row);
    return 0.02 * Normal(probe, row) + (probe == 1 ? 0.3 * mains : 0.0);
  };
  UseMeasuredNoise({Made("gap-steps", noise)}, setup);
  EXPECT_NEAR(setup.noise.Of(1), 20e-9, 3e-9);
  EXPECT_TRUE(setup.noisy.empty());
}

// The differences of neighbours would tell a third of it.
TEST(MeasuredNoise, KnowsNoiseWithAMemory) {
  simulation::Instruments setup = Stating(20.0);
  constexpr double kKept = 0.8;  // from one reading to the next
  double remembered = 0.0;
  const auto noise = [&](std::size_t probe, int row) {
    if (probe != 2) return 0.02 * Normal(probe, row);
    remembered = kKept * remembered + 0.02 * std::sqrt(1.0 - kKept * kKept) * Normal(probe, row);
    return remembered;
  };
  UseMeasuredNoise({Made("gap-steps", noise)}, setup);
  EXPECT_NEAR(std::hypot(setup.noise.Of(2), setup.noise.memory[2]), 20e-9, 5e-9);
  EXPECT_NEAR(std::exp(-kStep / setup.noise.memory_time[2]), kKept, 0.12);
  EXPECT_EQ(setup.noise.memory[0], 0.0);
  EXPECT_THAT(setup.notes, testing::Contains(testing::HasSubstr("probe_c go on")));
}

}  // namespace measured_noise_test
}  // namespace abbe::diagnosis
