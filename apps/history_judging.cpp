// What judges campaigns: abbe history compare, trend, check.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/command.h"
#include "apps/history_json.h"
#include "apps/history_options.h"
#include "apps/history_text.h"
#include "apps/result_file.h"
#include "failure/failure.h"
#include "history/comparison.h"
#include "history/conformity.h"
#include "history/trend.h"
#include "settings/nearest_word.h"

namespace abbe::apps {
namespace {

namespace fs = std::filesystem;
using history::Limits;

Limits LimitsIn(const settings::Document& document) { return history::ReadLimits(document.Root()); }

// The machine that is named, or the only one.
std::string MachineOf(const HistoryOptions& options, const history::Store& store) {
  if (!options.machine.empty()) return options.machine;
  const auto machines = store.Machines();
  if (machines.size() == 1) return machines.front();
  throw InputError(machines.empty()
                       ? std::string("the history holds no campaign yet; add one first")
                       : fmt::format("the history holds {} machines; choose one with --machine {}",
                                     machines.size(), Printable(machines.front())));
}

// The object and the quantity of a name: "EYX", "EYX.straightness_um" or "straightness_um".
struct FigureName {
  std::string object, quantity;
};

FigureName NameOf(const std::string& typed, const std::vector<std::string>& known) {
  std::vector<std::string> names;
  for (const std::string& name : known) {
    const auto dot = name.find('.');
    const FigureName parts{dot == std::string::npos ? "" : name.substr(0, dot),
                           dot == std::string::npos ? name : name.substr(dot + 1)};
    if (typed == name) return parts;
    if (typed == parts.object) return {parts.object, ""};
    if (typed == parts.quantity) return {"", parts.quantity};
    for (const std::string& each : {name, parts.object, parts.quantity}) {
      if (!each.empty()) names.push_back(each);
    }
  }
  const std::string nearest = settings::NearestWord(typed, names);
  throw InputError(nearest.empty()
                       ? fmt::format("{}: the campaigns of this machine have no figures", typed)
                       : fmt::format("{}: no campaign of this machine has such a figure; did you "
                                     "mean {}?",
                                     typed, nearest));
}

struct Measured {
  std::string machine, of;
  std::vector<history::Figure> figures;
};

template <typename Results>
std::vector<history::Figure> FiguresIn(const Results& results) {
  std::vector<history::Figure> figures;
  for (const auto& result : results) {
    figures.insert(figures.end(), result.extract.figures.begin(), result.extract.figures.end());
  }
  return figures;
}

Measured MeasuredIn(const HistoryOptions& options) {
  if (fs::exists(options.campaign)) {
    history::CampaignOptions of{.machine = options.machine_file,
                                .who = {},
                                .note = {},
                                .instruments = {},
                                .measured = SecondsNow(),
                                .now = 0.0};
    const auto campaign = history::ReadCampaign({options.campaign}, of);
    for (const std::string& note : campaign.notes) fmt::print(stderr, "abbe: {}\n", note);
    return {campaign.machine, campaign.name, FiguresIn(campaign.results)};
  }
  const history::Store store = OpenStore(options, history::Store::Missing::kRefuse);
  auto campaign = store.Read(CampaignNumber(options.campaign, "", store));
  for (auto& result : campaign.results) history::AddStations(result.content, result.extract);
  return {campaign.head.machine, fmt::format("campaign {}", campaign.head.id),
          FiguresIn(campaign.results)};
}

}  // namespace

int CompareCampaigns(const HistoryOptions& options) {
  const history::Store store = OpenStore(options, history::Store::Missing::kRefuse);
  const auto before = store.Read(CampaignNumber(options.campaign, options.machine, store));
  const auto after = store.Read(CampaignNumber(options.other, options.machine, store));
  const auto comparison = history::Compare(before, after, options.level);
  ShowHistory(options, ComparisonText(comparison));
  KeepHistory(options, ComparisonJson(comparison));
  return kDone;
}

int FollowFigures(const HistoryOptions& options) {
  const history::Store store = OpenStore(options, history::Store::Missing::kRefuse);
  const std::string machine = MachineOf(options, store);
  const auto campaigns = store.List(machine);
  const FigureName name = NameOf(options.figure, store.FigureNames(machine));
  std::map<std::string, std::vector<history::Point>> series;
  for (const auto& point : store.PointsOf(machine, name.object, name.quantity)) {
    series[point.figure.Name() + "\n" + point.figure.conditions].push_back(point);
  }
  Limits limits;
  if (const auto file = store.MachineFileOf(machine)) {
    limits = LimitsIn(settings::Document::Parse(file->content, file->name));
  }
  const auto instruments = store.InstrumentsOf(machine);
  std::vector<history::Trend> trends;
  std::string text;
  for (const auto& [key, points] : series) {
    const auto& figure = points.front().figure;
    const history::Limit* const limit = history::LimitOf(figure.object, figure.quantity, limits);
    trends.push_back(history::FollowFigure(
        points, instruments,
        {.limit = limit != nullptr ? std::optional(limit->size) : std::nullopt,
         .now = SecondsNow()}));
    text += TrendText(trends.back());
  }
  const auto notes = history::OutOfOrder(campaigns);
  for (const std::string& note : notes) text += "note: " + note + "\n";
  ShowHistory(options, text);
  KeepHistory(options, TrendsJson(machine, trends, notes));
  return kDone;
}

int CheckLimits(const HistoryOptions& options) {
  const auto document = settings::Document::Read(options.machine_file);
  const Limits limits = LimitsIn(document);
  if (limits.empty()) {
    throw InputError(fmt::format(
        "{}: has no [limits]; state some, for example circularity_um = 5.0 (docs/history.md)",
        options.machine_file.string()));
  }
  const Measured measured = MeasuredIn(options);
  if (const std::string name = document.Root().Text("name"); name != measured.machine) {
    throw InputError(fmt::format("{}: describes \"{}\", but {} is of \"{}\"",
                                 options.machine_file.string(), name, measured.of,
                                 measured.machine));
  }
  const auto judged =
      history::Judge(measured.figures, limits, history::ReadTravels(document.Root()));
  ShowHistory(options, CheckText(judged));
  KeepHistory(options, CheckJson(measured.machine, measured.of, judged));
  const auto count = [&](history::Verdict verdict) {
    return std::ranges::count(judged, verdict, &history::Judged::verdict);
  };
  const auto failed = count(history::Verdict::kFail);
  const auto undecided = count(history::Verdict::kUndecided);
  const auto missing = count(history::Verdict::kNotMeasured);
  if (failed > 0) fmt::print(stderr, "abbe: {} of {} figures fail\n", failed, judged.size());
  if (undecided > 0) {
    fmt::print(stderr, "abbe: {} of {} figures are undecided: neither pass nor fail is proven\n",
               undecided, judged.size());
  }
  if (missing > 0) fmt::print(stderr, "abbe: {} limits have no figure here\n", missing);
  const bool met = failed == 0 && (!options.proven || undecided + missing == 0);
  return met ? kDone : kRequirementNotMet;
}

}  // namespace abbe::apps
