// Plates among the runs of a diagnosis: the five set-ups of the virtual rig and the first one
// again, one hole every 20 s, on a machine that is steady or whose X axis creeps while it warms up.
#include <gtest/gtest.h>

#include <cmath>

#include "../folders.h"
#include "diagnosis/diagnose.h"
#include "rig/record_plate.h"
#include "rig/rig_settings.h"
#include "settings/document.h"
#include "standards/coverage.h"

namespace abbe::diagnosis {
namespace plate_hidden_test {

constexpr double kHoleEvery = 20.0, kTimeConstant = 300.0;  // s
constexpr std::uint64_t kSeeds = 5;

const settings::Document& Demo() {
  static const settings::Document document = settings::Document::Read(DemoMillFile());
  return document;
}

std::vector<double>& Column(recording::Recording& recording, const std::string& name) {
  for (auto& column : recording.columns) {
    if (column.name == name) return column.values;
  }
  throw std::runtime_error("no column " + name);
}

// Where X shows x, it stands at x + drift.
recording::Recording PlateOf(std::uint64_t seed, double drift_mm) {
  const rig::World world(rig::ReadRigSettings(Demo().Root()), seed);
  rig::PlateProgram program;
  program.setups.push_back(program.setups.front());
  recording::Recording plate = rig::RecordPlate(world, program);
  for (std::size_t row = 0; row < plate.rows(); ++row) {
    const double time = kHoleEvery * static_cast<double>(row);
    Column(plate, "time_s")[row] = time;
    Column(plate, "x_mm")[row] -= drift_mm * (1.0 - std::exp(-time / kTimeConstant));
  }
  return plate;
}

Diagnosis DiagnosisOf(const recording::Recording& plate) {
  Campaign campaign({machine::ReadMachine(Demo().Root()), std::nullopt, {}, {}, std::nullopt});
  campaign.Add(plate);
  return Diagnose(campaign);
}

TEST(Plates, OfASteadyMachineAreClean) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    EXPECT_EQ(DiagnosisOf(PlateOf(seed, 0.0)).verdict, Verdict::kClean) << seed;
  }
}

TEST(Plates, TellThatAnAxisCreeps) {
  constexpr double kDrift = 5e-3;   // mm
  constexpr double kRarely = 1.75;  // times U95
  // m: the bound of Cramer and Rao for a drift, its time constant and a place, of 49 differences of
  // two holes with 0.2 um each, 20 s apart; the errors of the machine cost more.
  constexpr double kKnownMachine = 0.153e-6;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Diagnosis diagnosis = DiagnosisOf(PlateOf(seed, kDrift));
    EXPECT_EQ(diagnosis.verdict, Verdict::kExplained) << seed;
    ASSERT_EQ(diagnosis.findings.size(), 1u) << seed;
    const Score& found = diagnosis.findings[0].score;
    EXPECT_EQ(found.candidate.Name(), "warm-up-drift:X") << seed;
    const Keys keys = KeysOf(found);
    ASSERT_EQ(keys.values.size(), 2);
    EXPECT_NEAR(keys.values[0], 1e-3 * kDrift, kRarely * standards::kCoverage * keys.u[0]) << seed;
    EXPECT_NEAR(keys.values[1], kTimeConstant, kRarely * standards::kCoverage * keys.u[1]) << seed;
    EXPECT_GT(keys.u[0], kKnownMachine) << seed;
    EXPECT_LT(keys.u[0], 1.5 * kKnownMachine) << seed;
  }
}

}  // namespace plate_hidden_test
}  // namespace abbe::diagnosis
