// Size of a history in SQLite, time to fill it, and time of its queries.
//
//   bench/history_store MACHINES CAMPAIGNS
//
// Each machine has CAMPAIGNS campaigns of one result with 24 figures and a JSON of 2 kB, about what
// a circular test and a squareness leave. Filled in transactions of a machine each, as an import
// does; one campaign after the other, as a user adds them, is measured apart. Queries: median and
// largest over 50 machines, each in its own connection for the first and in one for the rest.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "history/store.h"
#include "history/trend.h"
#include "random/counter_random.h"
#include "recording/file_hash.h"

namespace {

using namespace abbe;
namespace fs = std::filesystem;

constexpr int kFigures = 24, kAsked = 50, kSingle = 200;
constexpr double kFirst = 1.6e9, kDay = 86400.0;

double Seconds(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

history::Campaign Made(int machine, int number) {
  const random::CounterRandom draw(static_cast<std::uint64_t>(machine), 1);
  const std::string text =
      fmt::format("{{\"machine\": {}, \"campaign\": {}}}{:2000}", machine, number, "");
  history::Campaign campaign;
  campaign.machine = fmt::format("machine {:04}", machine);
  campaign.measured = kFirst + kDay * number;
  history::ResultFile result{
      "circle.json", recording::Sha256OfText(text), text, "circle", "", campaign.measured, {}};
  for (int i = 0; i < kFigures; ++i) {
    const auto index = static_cast<std::uint64_t>(number * kFigures + i);
    result.extract.figures.push_back({fmt::format("E{:02}", i),
                                      "straightness_um",
                                      "",
                                      3.0 + 1e-3 * number + 0.1 * draw.Normal(index),
                                      0.1,
                                      2.0,
                                      {{"head", 0.5}}});
  }
  campaign.results.push_back(std::move(result));
  return campaign;
}

void Print(const char* what, std::vector<double> times) {
  std::ranges::sort(times);
  fmt::print("{:<44}{:>9.2f} ms median {:>9.2f} ms largest\n", what, 1e3 * times[times.size() / 2],
             1e3 * times.back());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    fmt::print(stderr, "usage: history_store MACHINES CAMPAIGNS\n");
    return 2;
  }
  const int machines = std::atoi(argv[1]), campaigns = std::atoi(argv[2]);
  const fs::path folder =
      fs::temp_directory_path() / fmt::format("abbe_history_{}", fmt::ptr(&machines));
  fs::create_directories(folder);
  const history::StoreAddress address{.file = folder / "history.db"};
  {
    history::Store store(address, history::Store::Missing::kMake);
    double filling = 0.0;
    for (int machine = 0; machine < machines; ++machine) {
      std::vector<history::Campaign> all;
      all.reserve(static_cast<std::size_t>(campaigns));
      for (int number = 0; number < campaigns; ++number) all.push_back(Made(machine, number));
      filling += Seconds([&] { store.AddAll(all, kFirst); });
    }
    const double count = 1.0 * machines * campaigns;
    fmt::print(
        "{} machines x {} campaigns, {} figures each: filled in {:.1f} s, {:.2f} ms a "
        "campaign\n",
        machines, campaigns, kFigures, filling, 1e3 * filling / count);
    std::vector<double> single;
    for (int i = 0; i < kSingle; ++i) {
      const auto campaign = Made(machines, i);
      single.push_back(Seconds([&] { store.Add(campaign, kFirst); }));
    }
    Print("one more campaign, on the disk", single);
  }
  const auto size = static_cast<double>(fs::file_size(address.file));
  fmt::print("{:<44}{:>9.1f} MB, {:.1f} kB a campaign\n", "size", 1e-6 * size,
             1e-3 * size / (machines * campaigns + kSingle));
  std::vector<double> opened, trend, list, names;
  history::Store store(address, history::Store::Missing::kRefuse);
  for (int i = 0; i < kAsked; ++i) {
    const std::string machine = fmt::format("machine {:04}", (i * 7919) % machines);
    opened.push_back(Seconds([&] {
      const history::Store other(address, history::Store::Missing::kRefuse);
      other.PointsOf(machine, "E07", "straightness_um");
    }));
    trend.push_back(Seconds([&] {
      history::FollowFigure(store.PointsOf(machine, "E08", "straightness_um"),
                            store.InstrumentsOf(machine), {.limit = 5.0, .now = kFirst * 2});
    }));
    list.push_back(Seconds([&] { store.List(machine); }));
    names.push_back(Seconds([&] { store.FigureNames(machine); }));
  }
  Print("open and read one figure of a machine", opened);
  Print("trend of one figure of a machine", trend);
  Print("list of the campaigns of a machine", list);
  Print("names of the figures of a machine", names);
  fs::remove_all(folder);
}
