// A tolerance of zero takes no cause away.
#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "../folders.h"
#include "diagnosis/evidence.h"
#include "diagnosis/extended_run.h"
#include "rig/campaign.h"
#include "settings/document.h"

namespace abbe::diagnosis {
namespace zero_tolerance_test {

TEST(ZeroTolerance, LeavesTheCausesThatWidenIt) {
  simulation::Trace trace;
  trace.linkage.emplace();
  trace.linkage->angles = Eigen::MatrixXd::Zero(3, 4);
  const simulation::Scene scene{{&trace}, Eigen::Vector3d::Constant(0.1)};
  const auto block = [](const char* name) {
    estimation::ParameterBlock made(name, {"", 1.0}, {});
    made.entries.push_back({.name = "after_pivot_2", .held = true});
    made.entries.push_back({.name = "after_pivot_3", .prior_sd = 3e-6});
    return made;
  };
  std::vector<estimation::ParameterBlock> blocks{block("expansion"), block("length")};
  FreeForCauses(scene, blocks);
  const auto& expansion = blocks[0].entries;
  EXPECT_FALSE(expansion[0].held);
  EXPECT_GT(expansion[0].prior_sd, 0.0);
  EXPECT_LT(expansion[0].prior_sd, 1e-6);  // no more than a tenth of what a link can have: 10 ppm/K
  EXPECT_EQ(expansion[1].prior_sd, 3e-6);
  EXPECT_TRUE(blocks[1].entries[0].held);  // what no cause is about
}

std::string DemoMill() {
  std::ifstream file(DemoMillFile());
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

// The keys of all tables [...tolerance], and what else states how large something can be; a
// population without squareness is refused.
std::vector<std::string> Tolerances(const std::string& text) {
  std::vector<std::string> keys{"scale_ppm", "u_squareness_urad", "form_nm"};
  const std::regex table(R"(\[\w+\.tolerance\]\n((?:\w+ = .*\n)+))"), line(R"((\w+) = )");
  for (std::sregex_iterator each(text.begin(), text.end(), table), end; each != end; ++each) {
    const std::string lines = (*each)[1];
    for (std::sregex_iterator key(lines.begin(), lines.end(), line); key != end; ++key) {
      keys.push_back((*key)[1]);
    }
  }
  return keys;
}

std::string WithZero(const std::string& text, const std::string& key) {
  return std::regex_replace(text, std::regex("\n" + key + " = .*"), "\n" + key + " = 0.0");
}

// The causes that would be seen at all with this machine file.
std::set<std::string> SeenWith(const std::string& text,
                               const std::vector<recording::Recording>& recordings) {
  const auto document = settings::Document::Parse(text, "mill.toml");
  const auto& root = document.Root();
  Campaign campaign({machine::ReadMachine(root), probes::ReadHeadSettings(root),
                     probes::ReadTargetSettings(root), probes::ReadProbeNoise(root),
                     relm::ReadLinkageSettings(root)});
  for (const auto& recording : recordings) campaign.Add(recording);
  const Fit fit(campaign);
  std::set<std::string> seen;
  for (const Score& score : ScoreAll(fit, AllCandidates(campaign.scene(), 1.0))) {
    if (score.visible > 0.0) seen.insert(score.candidate.Name());
  }
  return seen;
}

TEST(ZeroTolerance, OfAnyKeyOfTheMachineFileTakesNoCauseAway) {
  const std::string text = DemoMill();
  const auto document = settings::Document::Parse(text, "mill.toml");
  const auto world = rig::RecordCampaign(rig::ReadCampaignMachine(document.Root()), 31, {},
                                         {.kind = rig::CampaignKind::kMinimal, .reduced = true});
  const std::set<std::string> seen = SeenWith(text, world.recordings);
  ASSERT_TRUE(seen.contains("squareness:XY"));
  ASSERT_TRUE(seen.contains("link-gravity-bend:pivot_2"));
  const std::vector<std::string> tolerances = Tolerances(text);
  ASSERT_EQ(tolerances.size(), 20u);
  std::string none = text;
  for (const std::string& key : tolerances) {
    EXPECT_EQ(SeenWith(WithZero(text, key), world.recordings), seen) << key;
    none = WithZero(none, key);
  }
  // What the tolerances hide otherwise may be seen besides.
  const std::set<std::string> with_none = SeenWith(none, world.recordings);
  for (const std::string& name : seen) EXPECT_TRUE(with_none.contains(name)) << name;
}

}  // namespace zero_tolerance_test
}  // namespace abbe::diagnosis
