// Does the diagnosis find what a turning wheel hides, and nothing where nothing is?
// Worlds: ABBE_SEEDS, ABBE_SHARD.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "random/counter_random.h"
#include "tests/diagnosis/shaft_world.h"
#include "tests/hidden_effects/judgement.h"
#include "tests/seeds.h"

namespace abbe {
namespace shaft_hidden_test {

constexpr double kNormal = 3.9;  // 99.99 % of normal errors
constexpr double kLarge = 5.0;   // m: a rim so large that its curvature is none of a sensor

Diagnosis DiagnosisOf(const std::vector<Wheel>& wheels, std::uint64_t seed) {
  diagnosis::Campaign campaign(SetupOfWheel());
  for (std::size_t i = 0; i < wheels.size(); ++i) {
    campaign.Add(WheelUnderSensors(wheels[i], seed).Record(fmt::format("turning {}", i)));
  }
  Diagnosis diagnosis = diagnosis::Diagnose(campaign);
  fmt::print("seed {}: {}\n", seed, diagnosis::Name(diagnosis.verdict));
  for (const Finding& finding : diagnosis.findings) {
    const auto keys = diagnosis::KeysOf(finding.score);
    fmt::print("  {} {:.3f}", finding.score.candidate.Name(), finding.probability);
    for (Eigen::Index i = 0; i < keys.values.size(); ++i) {
      fmt::print(" {:.4g}+-{:.2g}", keys.values[i], 2.0 * keys.u[i]);
    }
    fmt::print("\n");
  }
  for (const auto& left : diagnosis.leftovers) {
    fmt::print("  left: {} {} {:.3g} p {:.2g}\n", left.object, left.variable, left.amplitude,
               left.p_value);
  }
  return diagnosis;
}

const Finding* Found(const Diagnosis& diagnosis, const std::string& name) {
  const auto found =
      std::find_if(diagnosis.findings.begin(), diagnosis.findings.end(),
                   [&](const Finding& finding) { return finding.score.candidate.Name() == name; });
  return found == diagnosis.findings.end() ? nullptr : &*found;
}

void ExpectKey(const Diagnosis& diagnosis, const std::string& name, Eigen::Index key,
               double truth) {
  const Finding* finding = Found(diagnosis, name);
  ASSERT_NE(finding, nullptr) << name;
  const auto keys = diagnosis::KeysOf(finding->score);
  EXPECT_NEAR(keys.values[key], truth, kNormal * keys.u[key]) << name << " key " << key;
}

TEST(TurningWheels, ShowNothingWhereNothingIsHidden) {
  const Seeds seeds = SeedsFromEnvironment();
  Rate alarms;
  for (std::uint64_t seed = seeds.first; seed <= seeds.last; seed += seeds.step) {
    alarms.Add(DiagnosisOf({Wheel{}}, seed).verdict != Verdict::kClean);
  }
  EXPECT_LE(alarms.Low(), 0.01) << alarms.Text();
}

TEST(TurningWheels, TellEccentricityLobesAndGain) {
  Wheel wheel{.eccentricity = 50e-6, .phase = 0.7, .sin3 = 2e-6, .cos3 = -1e-6};
  wheel.gain[1] = 1.05;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Diagnosis diagnosis = DiagnosisOf({wheel}, seed);
    EXPECT_EQ(diagnosis.verdict, Verdict::kExplained);
    EXPECT_EQ(diagnosis.findings.size(), 3U);
    EXPECT_EQ(diagnosis.findings.front().score.candidate.Name(), "target-eccentricity:shaft");
    ExpectKey(diagnosis, "target-eccentricity:shaft", 0, 50e-6);
    ExpectKey(diagnosis, "target-eccentricity:shaft", 1, 0.7);
    ExpectKey(diagnosis, "target-lobing:shaft", 2, 2e-6);
    ExpectKey(diagnosis, "target-lobing:shaft", 3, -1e-6);
    ExpectKey(diagnosis, "sensor-gain:sensor_2", 0, 0.05);
  }
}

// No two sensors show the same of a motion; where the difference is too small to be found, sizes are
// as uncertain as it leaves them.
TEST(TurningWheels, KnowSizesBesideGainsThatAreNotFound) {
  constexpr std::uint64_t kSeeds = 12;
  Rate inside;
  for (const double size : {0.001, 0.002, 0.004}) {
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      const random::CounterRandom draw(seed, 0x6A1);
      Wheel wheel{.radius = kLarge, .eccentricity = 60e-6, .phase = 1.0};
      for (std::size_t sensor = 1; sensor <= 2; ++sensor) {
        wheel.gain[sensor] += size * draw.Normal(sensor);
      }
      const Diagnosis diagnosis = DiagnosisOf({wheel}, seed);
      const Finding* found = Found(diagnosis, "target-eccentricity:shaft");
      ASSERT_NE(found, nullptr);
      const auto keys = diagnosis::KeysOf(found->score);
      inside.Add(std::abs(keys.values[0] - wheel.eccentricity) < 1.96 * keys.u[0]);
      inside.Add(std::abs(keys.values[1] - wheel.phase) < 1.96 * keys.u[1]);
    }
  }
  fmt::print("inside U95: {}\n", inside.Text());
  EXPECT_GE(inside.High(), 0.95) << inside.Text();
}

// As on the target wheel of the field test.
TEST(TurningWheels, TellGainsThatDifferByHalf) {
  Wheel wheel{.radius = kLarge, .eccentricity = 300e-6, .phase = -2.0, .noise = 3e-6};
  wheel.gain = {1.0, 1.55, 1.39};
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Diagnosis diagnosis = DiagnosisOf({wheel}, seed);
    EXPECT_EQ(diagnosis.verdict, Verdict::kExplained);
    EXPECT_EQ(diagnosis.findings.size(), 3U);
    ExpectKey(diagnosis, "target-eccentricity:shaft", 0, 300e-6);
    ExpectKey(diagnosis, "sensor-gain:sensor_2", 0, 0.55);
    ExpectKey(diagnosis, "sensor-gain:sensor_3", 0, 0.39);
  }
}

TEST(TurningWheels, TellACurvedSensor) {
  Wheel wheel{.radius = kLarge, .eccentricity = 200e-6};
  wheel.quadratic[2] = 50.0;
  const Diagnosis diagnosis = DiagnosisOf({wheel}, 1);
  EXPECT_EQ(diagnosis.verdict, Verdict::kExplained);
  EXPECT_EQ(diagnosis.findings.size(), 2U);
  ExpectKey(diagnosis, "sensor-nonlinearity:sensor_3", 0, 50.0);
}

// Twice per turn three evenly spaced sensors take one for the other; uneven ones do not.
TEST(TurningWheels, TellAWanderingAxisFromForm) {
  Wheel wheel{.eccentricity = 30e-6, .sin2x = 2e-6, .cos2y = 1e-6};
  wheel.sensor_degrees = {0.0, 99.0, 203.0};
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Diagnosis diagnosis = DiagnosisOf({wheel}, seed);
    EXPECT_EQ(diagnosis.verdict, Verdict::kExplained);
    EXPECT_EQ(diagnosis.findings.size(), 2U);
    // sin2x and cos2y where the places are counted with the shaft.
    ExpectKey(diagnosis, "shaft-error-motion:shaft", 0, 2e-6);
    ExpectKey(diagnosis, "shaft-error-motion:shaft", 3, 1e-6);
  }
}

TEST(TurningWheels, TellALateClockByASecondSpeed) {
  const Wheel slow{.eccentricity = 100e-6, .phase = 1.0, .delay = 20e-3, .rpm = 6.0, .turns = 3.0};
  Wheel fast = slow;
  fast.rpm = 25.0;
  const Diagnosis one = DiagnosisOf({fast}, 1);
  EXPECT_EQ(one.verdict, Verdict::kExplained);
  EXPECT_EQ(one.findings.size(), 1U);
  EXPECT_NE(std::find(one.cannot_show.begin(), one.cannot_show.end(), "clock-skew:shaft"),
            one.cannot_show.end());
  const Diagnosis both = DiagnosisOf({slow, fast}, 1);
  EXPECT_EQ(both.verdict, Verdict::kExplained);
  EXPECT_EQ(both.findings.size(), 2U);
  ExpectKey(both, "target-eccentricity:shaft", 1, 1.0);
  ExpectKey(both, "clock-skew:shaft", 0, 20e-3);
}

}  // namespace shaft_hidden_test
}  // namespace abbe
