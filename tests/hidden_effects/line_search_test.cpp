// A line in time that the rig hides is found among all frequencies, and none where there is none.
#include "diagnosis/line_search.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "simulation/causes/registry.h"
#include "tests/hidden_effects/hidden_world.h"

namespace abbe {
namespace line_search_test {

constexpr std::uint64_t kSeed = 5;

struct Found {
  diagnosis::Line line;
  double span = 0.0;  // s, of the runs of the linkage: of each row a single reading

  double LogEvidence() const { return line.score.log_evidence - std::log(line.among); }
};

Found LineOf(const std::vector<std::string>& hidden) {
  const HiddenWorlds worlds(rig::CampaignKind::kMinimal);
  const diagnosis::Campaign campaign = worlds.Recordings(worlds.Record(kSeed, hidden));
  const diagnosis::Fit fit(campaign);
  const simulation::Cause& vibration = simulation::CauseNamed("vibration");
  const auto shapes = vibration.shapes(campaign.scene());
  Found found{diagnosis::StrongestLine(fit, {&vibration, "X", shapes.front()})};
  double first = std::numeric_limits<double>::infinity();
  for (const simulation::Trace* trace : campaign.scene().traces) {
    if (!trace->linkage) continue;
    first = std::min(first, trace->clock.minCoeff());
    found.span = std::max(found.span, trace->clock.maxCoeff() - first);
  }
  return found;
}

class HiddenLines : public testing::TestWithParam<double> {};

TEST_P(HiddenLines, AreFoundToAWaveOverTheRuns) {
  const double frequency = GetParam();
  const Found found =
      LineOf({fmt::format("vibration:object=X:frequency_hz={}:amplitude_um=0.5", frequency)});
  EXPECT_GT(found.LogEvidence(), 10.0);
  EXPECT_NEAR(found.line.score.candidate.shape[0], frequency, 1.0 / found.span);
}

INSTANTIATE_TEST_SUITE_P(BetweenDriftAndMains, HiddenLines, testing::Values(4.7, 17.3, 38.2));

TEST(LineSearch, FindsNothingInNoise) { EXPECT_LT(LineOf({}).LogEvidence(), 0.0); }

}  // namespace line_search_test
}  // namespace abbe
