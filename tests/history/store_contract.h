// What a store keeps to, of whichever kind: run by the tests of SQLite and of PostgreSQL.
#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "made_campaign.h"

namespace abbe::history {

inline constexpr double kMade = 1.75e9;  // s, the instant of the first campaign

// Names that would end a text of SQL or HTML.
inline const std::string kHostile = R"(mill'); drop table figure; -- "<script>alert(1)</script>)";

inline ResultFile FullResult(double measured, const std::string& text) {
  ResultFile result =
      MadeResult({{"EYX", "straightness_um", "", 0.1 + 0.2, 1e-3, 2.5, {{"head", 0.5}}},
                  {"X", "positioning_A_um", "", 6.0, std::nullopt}},
                 measured, text);
  result.extract.curves.push_back({"EYX",
                                   "um",
                                   "sweep",
                                   {0, 10, 20},
                                   {0.1, std::numeric_limits<double>::quiet_NaN(), 0.3},
                                   {0.01, 0.02, 0.03},
                                   2.5,
                                   {{"head", 0.5}}});
  result.extract.findings.push_back({"backlash", "X", 0.99});
  result.extract.verdict = "explained";
  return result;
}

inline void KeepsCampaigns(const StoreAddress& address) {
  Store store(address, Store::Missing::kMake);
  Campaign campaign = MadeCampaign(kHostile, kMade, {FullResult(kMade, R"({"a": 1})")});
  campaign.serial = "4711";
  campaign.note = kHostile;
  campaign.instruments = {{"head", kHostile}};
  campaign.machine_file = TextFile{"mill.toml", "f00", "name = \"mill\"\n"};
  campaign.recordings = {
      {"/data/\xff.csv", "beef", "sweep", "2026-11-21T09:00:00Z", 5'000'000'000}};
  campaign.maps = {{"map.toml", "cafe", "# An error map:"}};
  const Added added = store.Add(campaign, kMade + 60.0);
  ASSERT_TRUE(added.campaign);

  const StoredCampaign stored = store.Read(*added.campaign);
  EXPECT_EQ(stored.head.machine, kHostile);
  EXPECT_EQ(stored.head.note, kHostile);
  EXPECT_EQ(stored.head.measured, kMade);
  EXPECT_EQ(stored.head.added, kMade + 60.0);
  EXPECT_EQ(stored.instruments.at("head"), kHostile);
  EXPECT_EQ(stored.instruments.at("serial"), "4711");
  EXPECT_EQ(stored.machine_file->content, "name = \"mill\"\n");
  EXPECT_EQ(stored.recordings.front().bytes, 5'000'000'000);
  EXPECT_EQ(stored.recordings.front().path, "/data/?.csv");
  EXPECT_EQ(stored.maps.front().content, "# An error map:");
  ASSERT_EQ(stored.results.size(), 1U);
  const ResultFile& result = stored.results.front();
  EXPECT_EQ(result.content, R"({"a": 1})");
  EXPECT_EQ(result.extract.verdict, "explained");
  ASSERT_EQ(result.extract.figures.size(), 2U);
  EXPECT_EQ(result.extract.figures[0].value, 0.1 + 0.2);  // to the last bit
  EXPECT_EQ(*result.extract.figures[0].u, 1e-3);
  EXPECT_EQ(result.extract.figures[0].shares.at("head"), 0.5);
  EXPECT_FALSE(result.extract.figures[1].u);
  ASSERT_EQ(result.extract.curves.size(), 1U);
  EXPECT_EQ(result.extract.curves[0].value[2], 0.3);
  EXPECT_TRUE(std::isnan(result.extract.curves[0].value[1]));
  EXPECT_EQ(result.extract.findings.front().cause, "backlash");
}

inline void KeepsNothingTwice(const StoreAddress& address) {
  Store store(address, Store::Missing::kMake);
  const Campaign first = MadeCampaign("twice", kMade, {FullResult(kMade, "one")});
  const long long id = *store.Add(first, kMade).campaign;
  const Added again = store.Add(first, kMade);
  EXPECT_FALSE(again.campaign);
  EXPECT_EQ(again.already_in, id);
  const Added grown = store.Add(
      MadeCampaign("twice", kMade, {FullResult(kMade, "one"), FullResult(kMade, "two")}), kMade);
  ASSERT_TRUE(grown.campaign);
  EXPECT_EQ(grown.left_out, 1U);
  EXPECT_EQ(grown.already_in, id);
  EXPECT_EQ(store.PointsOf("twice", "EYX", "straightness_um").size(), 2U);
  // The same content of another machine is another measurement.
  EXPECT_TRUE(store.Add(MadeCampaign("other", kMade, {FullResult(kMade, "one")}), kMade).campaign);
}

inline void FindsWhatIsAskedFor(const StoreAddress& address) {
  Store store(address, Store::Missing::kMake);
  for (const double day : {2.0, 0.0, 1.0}) {
    const double instant = kMade + 86400.0 * day;
    store.Add(MadeCampaign("asked", instant, {FullResult(instant, std::to_string(day))}), kMade);
  }
  const auto points = store.PointsOf("asked", "EYX", "straightness_um");
  ASSERT_EQ(points.size(), 3U);
  EXPECT_EQ(points[0].measured, kMade);
  EXPECT_EQ(points[2].measured, kMade + 2 * 86400.0);
  EXPECT_EQ(store.PointsOf("asked", "", "").size(), 6U);
  EXPECT_EQ(store.FigureNames("asked"),
            (std::vector<std::string>{"EYX.straightness_um", "X.positioning_A_um"}));
  EXPECT_EQ(store.List("asked").size(), 3U);
  EXPECT_EQ(store.Read(store.Latest("asked")).head.measured, kMade + 2 * 86400.0);
  EXPECT_FALSE(store.MachineFileOf("asked"));
  ExpectHas(MessageOf<InputError>([&] { store.List("askd"); }), "did you mean \"asked\"?");
  ExpectHas(MessageOf<InputError>([&] { store.Read(999999); }), "campaign 999999: is not in");
}

inline void Forgets(const StoreAddress& address) {
  Store store(address, Store::Missing::kMake);
  const Campaign campaign = MadeCampaign("forgotten", kMade, {FullResult(kMade, "gone")});
  const long long id = *store.Add(campaign, kMade).campaign;
  store.Forget(id);
  MessageOf<InputError>([&] { store.Read(id); });
  for (const std::string& name : store.Machines()) EXPECT_NE(name, "forgotten");
  EXPECT_TRUE(store.Add(campaign, kMade).campaign);  // nothing of it is left
}

// Four writers with ten campaigns each, of which half are the same.
inline void TakesSeveralWriters(const StoreAddress& address) {
  constexpr int kWriters = 4, kEach = 10;
  Store(address, Store::Missing::kMake);
  std::vector<std::thread> writers;
  std::vector<int> added(kWriters, 0);
  for (int writer = 0; writer < kWriters; ++writer) {
    writers.emplace_back([&, writer] {
      Store store(address, Store::Missing::kMake);
      for (int i = 0; i < kEach; ++i) {
        const int name = i < kEach / 2 ? i : 100 * (writer + 1) + i;
        const auto result = FullResult(kMade + name, std::to_string(name));
        added[static_cast<std::size_t>(writer)] +=
            store.Add(MadeCampaign("busy", kMade + name, {result}), kMade).campaign ? 1 : 0;
      }
    });
  }
  for (std::thread& each : writers) each.join();
  int all = 0;
  for (const int each : added) all += each;
  constexpr int kDifferent = kEach / 2 + kWriters * kEach / 2;
  EXPECT_EQ(all, kDifferent);
  Store store(address, Store::Missing::kMake);
  EXPECT_EQ(store.List("busy").size(), static_cast<std::size_t>(kDifferent));
  EXPECT_EQ(store.PointsOf("busy", "", "").size(), static_cast<std::size_t>(2 * kDifferent));
}

inline void KeepsTheContract(const StoreAddress& address) {
  KeepsCampaigns(address);
  KeepsNothingTwice(address);
  FindsWhatIsAskedFor(address);
  Forgets(address);
  TakesSeveralWriters(address);
}

}  // namespace abbe::history
