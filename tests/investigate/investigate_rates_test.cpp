// How many minutes at the machine an investigation takes to a certain, right verdict, beside the
// campaigns of the virtual rig, and how often it is certain and wrong. Each row by itself
// (--gtest_filter); worlds: ABBE_SEEDS.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "rig/campaign.h"
#include "tests/hidden_effects/judgement.h"
#include "tests/investigate/investigated_world.h"
#include "tests/seeds.h"

namespace abbe {
namespace investigate_rates_test {

using investigate::Ended;
using investigate::Journal;

void ForEachSeed(const std::function<void(std::uint64_t seed)>& use) {
  const Seeds seeds = SeedsFromEnvironment();
  for (std::uint64_t seed = seeds.first; seed <= seeds.last; seed += seeds.step) use(seed);
}

double MinutesOf(InvestigatedMachine& machine, rig::CampaignKind kind) {
  const auto campaign = rig::RecordCampaign(machine.rig(), 1, {}, {.kind = kind, .reduced = true});
  return CostOfCampaign(campaign.recordings, machine.subject().costs).total();
}

// What came of the worlds of a row.
struct Row {
  std::vector<double> right;  // minutes to a certain, right verdict
  int worlds = 0, wrong = 0;  // certain and wrong
  Rate wrong_name;            // of these, with a cause that is not there
  std::map<std::string, int> open;

  double Median() {
    if (right.empty()) return 0.0;
    std::ranges::sort(right);
    return right[right.size() / 2];
  }
  void Print(const char* name) {
    std::string minutes, others;
    Median();
    for (const double each : right) minutes += fmt::format(" {:.0f}", each);
    for (const auto& [what, count] : open) others += fmt::format(" {} {}", count, what);
    fmt::print(
        "{}: {} worlds, {} certain and right, {} certain and wrong ({} by name); open:{}\n  minutes:{}\n",
        name, worlds, right.size(), wrong, wrong_name.met, others.empty() ? " none" : others,
        minutes);
  }
};

struct Result {
  Ended ended;
  bool is_certain;
  double minutes;
};

Result Investigated(InvestigatedMachine& machine, std::uint64_t seed,
                    const rig::HiddenEffects& hidden) {
  machine.subject().budget = MinutesOf(machine, rig::CampaignKind::kFull);
  const auto folder = EmptyFolder(fmt::format("world_{}_{}", getpid(), seed));
  Journal journal = Journal::In(folder, AboutDemo());
  WorldRecorder recorder(machine.rig(), seed, hidden);
  Ended ended = investigate::Investigate(machine.subject(), recorder, journal);
  const auto outcomes = journal.outcomes();
  const bool is_certain = !outcomes.empty() && outcomes.back().is_certain;
  std::string line = fmt::format(
      "{} {} -> {:.1f} min, {} runs, {}, {}", seed, rig::TruthOf(recorder.hidden()).dump(),
      journal.spent(), journal.steps(), outcomes.back().verdict, investigate::Text(ended.why));
  for (const auto& finding : outcomes.back().findings) {
    line += fmt::format("; {} {:.3f}", finding.name, finding.probability);
  }
  for (const auto& left : outcomes.back().left) line += "; left " + left;
  fmt::print("{}\n", line);
  std::fflush(stdout);
  std::filesystem::remove_all(folder);
  return {std::move(ended), is_certain, journal.spent()};
}

void Add(const Result& result, bool is_right, Row& row) {
  ++row.worlds;
  row.wrong_name.Add(result.is_certain && !is_right &&
                     result.ended.diagnosis->verdict == Verdict::kExplained);
  if (!result.is_certain) {
    ++row.open[std::string(Name(result.ended.diagnosis->verdict))];
  } else if (is_right) {
    row.right.push_back(result.minutes);
  } else {
    ++row.wrong;
  }
}

bool IsOfData(const rig::HiddenEffect& effect) {
  return effect.entry->name == "stuck-channel" || effect.entry->name == "outliers";
}

TEST(Investigate, WorldsWithOneEffect) {
  InvestigatedMachine machine;
  Row row;
  ForEachSeed([&](std::uint64_t seed) {
    const random::CounterRandom random(seed, 0x41DE);
    const auto hidden = machine.Hidden(seed, {DrawHidden(random, 0, true)});
    if (IsOfData(hidden.front())) return;
    const Result result = Investigated(machine, seed, hidden);
    const auto& findings = result.ended.diagnosis->findings;
    Add(result, findings.size() == 1 && Names(findings.front(), hidden.front()), row);
  });
  row.Print("one effect");
  EXPECT_LE(row.wrong_name.Low(), 0.02) << row.wrong_name.Text();
}

// The demonstration machine, rougher, with larger errors and noise than its file says.
settings::Document UnlikeTheFile() {
  std::ostringstream read;
  read << std::ifstream(DemoMillFile()).rdbuf();
  std::string text = read.str();
  const std::vector<std::pair<std::string, std::string>> changes{
      {"smoothness_mm = 15.0", "smoothness_mm = 8.0"},
      {"straightness_um = 1.0", "straightness_um = 2.0"},
      {"positioning_um = 2.0", "positioning_um = 4.0"},
      {"probe_nm = 20.0", "probe_nm = 35.0"},
      {"encoder_urad = 3.0", "encoder_urad = 5.0"}};
  for (const auto& [stated, real] : changes) {
    const std::size_t at = text.find(stated);
    EXPECT_NE(at, std::string::npos) << stated;
    text.replace(at, stated.size(), real);
  }
  return settings::Document::Parse(text, "world.toml");
}

TEST(Investigate, WorldsUnlikeTheFile) {
  InvestigatedMachine machine(UnlikeTheFile());
  Row with, without;
  ForEachSeed([&](std::uint64_t seed) {
    const random::CounterRandom random(seed, 0x41DE);
    const auto hidden = machine.Hidden(seed, {DrawHidden(random, 0, true)});
    if (IsOfData(hidden.front())) return;
    const Result found = Investigated(machine, seed, hidden);
    const auto& findings = found.ended.diagnosis->findings;
    Add(found, findings.size() == 1 && Names(findings.front(), hidden.front()), with);
    const Result nothing = Investigated(machine, seed, {});
    Add(nothing, nothing.ended.diagnosis->findings.empty(), without);
  });
  with.Print("unlike the file, one effect");
  without.Print("unlike the file, nothing");
  EXPECT_LE(with.wrong_name.Low(), 0.02) << with.wrong_name.Text();
  EXPECT_LE(without.wrong_name.Low(), 0.02) << without.wrong_name.Text();
}

TEST(Investigate, WorldsWithNothing) {
  InvestigatedMachine machine;
  Row row;
  ForEachSeed([&](std::uint64_t seed) {
    const Result result = Investigated(machine, seed, {});
    Add(result, result.ended.diagnosis->verdict == Verdict::kClean, row);
  });
  row.Print("nothing");
  EXPECT_LE(row.wrong_name.Low(), 0.02) << row.wrong_name.Text();
}

TEST(Investigate, WorldsOutsideTheCatalogue) {
  InvestigatedMachine machine;
  Row row;
  ForEachSeed([&](std::uint64_t seed) {
    const random::CounterRandom random(seed, 0x0BAD);
    const auto hidden = machine.Hidden(seed, {DrawHidden(random, 0, false)});
    Result result = Investigated(machine, seed, hidden);
    // Here the end is that the same is left again, which is not certain, but all that there is.
    result.is_certain = result.is_certain || result.ended.why == investigate::Why::kLeftAgain;
    Add(result,
        result.ended.diagnosis->verdict == Verdict::kUnexplained &&
            LivesIn(*result.ended.diagnosis, rig::TruthOf(hidden)[0].at("variable")),
        row);
  });
  row.Print("outside the catalogue");
  EXPECT_LE(row.wrong_name.Low(), 0.02) << row.wrong_name.Text();
}

TEST(Investigate, CostsBesideTheCampaigns) {
  InvestigatedMachine machine;
  const double standard = MinutesOf(machine, rig::CampaignKind::kStandard),
               full = MinutesOf(machine, rig::CampaignKind::kFull);
  fmt::print("standard campaign {:.0f} min, full campaign {:.0f} min\n", standard, full);
  EXPECT_GT(standard, 0.0);
  EXPECT_GT(full, standard);
}

}  // namespace investigate_rates_test
}  // namespace abbe
