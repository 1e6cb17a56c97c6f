// abbe history: what was measured on machines, kept, compared, followed and checked.
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/commands.h"
#include "apps/history_json.h"
#include "apps/history_text.h"
#include "apps/result_file.h"
#include "failure/failure.h"
#include "recording/instant.h"
#include "settings/nearest_word.h"
#include "settings/unit.h"

namespace abbe::apps {
namespace {

namespace fs = std::filesystem;
using history::Limits;
using history::Store;
using nlohmann::ordered_json;

struct HistoryOptions {
  std::string store;
  std::vector<fs::path> from;
  fs::path machine_file, json, out;
  std::string who, note, measured, machine, campaign, other, figure, format = "csv";
  std::vector<std::string> instruments;
  double level = history::kFamilyLevel;
  bool quiet = false, proven = false;
};

double Now() {
  return static_cast<double>(
      std::chrono::system_clock::to_time_t(std::chrono::system_clock::now()));
}

history::StoreAddress AddressOf(const HistoryOptions& options) {
  return options.store.empty() ? history::DefaultAddress() : history::ReadAddress(options.store);
}

Store Open(const HistoryOptions& options, Store::Missing missing) {
  const history::StoreAddress address = AddressOf(options);
  Store store(address, missing);
  if (options.store.empty() && !options.quiet) fmt::print("store: {}\n", address.Shown());
  for (const std::string& note : store.notes()) fmt::print(stderr, "abbe: {}\n", note);
  return store;
}

void Show(const HistoryOptions& options, const std::string& text) {
  if (!options.quiet) fmt::print("{}", text);
}

void Keep(const HistoryOptions& options, const ordered_json& result) {
  if (!options.json.empty()) WriteResult(result, options.json);
}

// A number, or "latest" of a machine.
long long CampaignOf(const std::string& text, const std::string& machine, const Store& store) {
  if (text == "latest") return store.Latest(machine);
  try {
    std::size_t end = 0;
    const long long id = std::stoll(text, &end);
    if (end == text.size()) return id;
  } catch (const std::logic_error&) {
  }
  throw InputError(fmt::format(
      "{}: is no campaign; give the number that abbe history list shows, or latest", text));
}

Limits LimitsIn(const settings::Document& document) { return history::ReadLimits(document.Root()); }

// Add ---------------------------------------------------------------------------------------------

std::map<std::string, std::string> InstrumentsOf(const std::vector<std::string>& texts) {
  std::map<std::string, std::string> instruments;
  for (const std::string& text : texts) {
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
      throw InputError(
          fmt::format("--instrument {}: is not ROLE=NAME, for example head=P-12", text));
    }
    instruments[text.substr(0, equals)] = text.substr(equals + 1);
  }
  return instruments;
}

history::CampaignOptions CampaignOptionsOf(const HistoryOptions& options) {
  history::CampaignOptions result{.machine = options.machine_file,
                                  .who = options.who,
                                  .note = options.note,
                                  .instruments = InstrumentsOf(options.instruments),
                                  .measured = {},
                                  .now = Now()};
  if (options.measured.empty()) return result;
  result.measured = recording::SecondsOf(options.measured);
  if (!result.measured) {
    throw InputError(
        fmt::format("--measured {}: is no instant; write 2026-11-21T09:00:00Z", options.measured));
  }
  return result;
}

std::string AddedText(const history::Added& added, const history::Campaign& campaign) {
  if (!added.campaign) {
    return fmt::format("{}: is in the history as campaign {}; nothing was added\n",
                       Printable(campaign.name), added.already_in);
  }
  std::string text = fmt::format(
      "campaign {}: {}, {}, {} results, {} recordings, {} maps\n", *added.campaign,
      Printable(campaign.machine), recording::InstantText(campaign.measured),
      campaign.results.size() - added.left_out, campaign.recordings.size(), campaign.maps.size());
  if (added.left_out > 0) {
    text += fmt::format("  {} of its results are in campaign {} already and were left out\n",
                        added.left_out, added.already_in);
  }
  return text;
}

// Each folder is a campaign; single files together are one.
int Add(const HistoryOptions& options) {
  std::vector<std::vector<fs::path>> groups;
  std::vector<fs::path> files;
  for (const fs::path& path : options.from) {
    if (!fs::exists(path)) {
      throw InputError(
          fmt::format("{}: there is no such file or folder; check the path", path.string()));
    }
    if (fs::is_directory(path)) {
      groups.push_back({path});
    } else {
      files.push_back(path);
    }
  }
  if (!files.empty()) groups.push_back(files);
  const history::CampaignOptions campaign_options = CampaignOptionsOf(options);
  std::optional<Store> store;
  if (!options.machine_file.empty()) {
    LimitsIn(settings::Document::Read(options.machine_file));
  }
  for (const auto& group : groups) {
    const history::Campaign campaign = history::ReadCampaign(group, campaign_options);
    for (const std::string& note : campaign.notes) fmt::print(stderr, "abbe: {}\n", note);
    if (!store) store.emplace(Open(options, Store::Missing::kMake));
    Show(options, AddedText(store->Add(campaign, Now()), campaign));
    std::fflush(stdout);  // what is said is stored
  }
  return kDone;
}

// List, show, forget ------------------------------------------------------------------------------

int List(const HistoryOptions& options) {
  const Store store = Open(options, Store::Missing::kRefuse);
  const auto campaigns = store.List(options.machine);
  Show(options, CampaignTable(campaigns));
  Keep(options, CampaignsJson(campaigns));
  return kDone;
}

int ShowCampaign(const HistoryOptions& options) {
  const Store store = Open(options, Store::Missing::kRefuse);
  const auto campaign = store.Read(CampaignOf(options.campaign, options.machine, store));
  Show(options, CampaignText(campaign));
  Keep(options, CampaignJson(campaign));
  return kDone;
}

int Forget(const HistoryOptions& options) {
  Store store = Open(options, Store::Missing::kRefuse);
  const long long campaign = CampaignOf(options.campaign, options.machine, store);
  store.Forget(campaign);
  Show(options,
       fmt::format("campaign {} is forgotten; its recordings stay where they are\n", campaign));
  return kDone;
}

// Compare, trend, check ---------------------------------------------------------------------------

int Compare(const HistoryOptions& options) {
  const Store store = Open(options, Store::Missing::kRefuse);
  const auto before = store.Read(CampaignOf(options.campaign, options.machine, store));
  const auto after = store.Read(CampaignOf(options.other, options.machine, store));
  const auto comparison = history::Compare(before, after, options.level);
  Show(options, ComparisonText(comparison));
  Keep(options, ComparisonJson(comparison));
  return kDone;
}

// The machine that is named, or the only one.
std::string MachineOf(const HistoryOptions& options, const Store& store) {
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

int Trend(const HistoryOptions& options) {
  const Store store = Open(options, Store::Missing::kRefuse);
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
        {.limit = limit != nullptr ? std::optional(limit->size) : std::nullopt, .now = Now()}));
    text += TrendText(trends.back());
  }
  const auto notes = history::OutOfOrder(campaigns);
  for (const std::string& note : notes) text += "note: " + note + "\n";
  Show(options, text);
  Keep(options, TrendsJson(machine, trends, notes));
  return kDone;
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

Measured MeasuredOf(const HistoryOptions& options) {
  if (fs::exists(options.campaign)) {
    history::CampaignOptions of{.machine = options.machine_file,
                                .who = {},
                                .note = {},
                                .instruments = {},
                                .measured = Now(),
                                .now = 0.0};
    const auto campaign = history::ReadCampaign({options.campaign}, of);
    for (const std::string& note : campaign.notes) fmt::print(stderr, "abbe: {}\n", note);
    return {campaign.machine, campaign.name, FiguresIn(campaign.results)};
  }
  const Store store = Open(options, Store::Missing::kRefuse);
  const auto campaign = store.Read(CampaignOf(options.campaign, "", store));
  return {campaign.head.machine, fmt::format("campaign {}", campaign.head.id),
          FiguresIn(campaign.results)};
}

int Check(const HistoryOptions& options) {
  const auto document = settings::Document::Read(options.machine_file);
  const Limits limits = LimitsIn(document);
  if (limits.empty()) {
    throw InputError(fmt::format(
        "{}: has no [limits]; state some, for example circularity_um = 5.0 (docs/history.md)",
        options.machine_file.string()));
  }
  const Measured measured = MeasuredOf(options);
  if (const std::string name = document.Root().Text("name"); name != measured.machine) {
    throw InputError(fmt::format("{}: describes \"{}\", but {} is of \"{}\"",
                                 options.machine_file.string(), name, measured.of,
                                 measured.machine));
  }
  const auto judged = history::Judge(measured.figures, limits);
  Show(options, CheckText(judged));
  Keep(options, CheckJson(measured.machine, measured.of, judged));
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

// Export ------------------------------------------------------------------------------------------

// RFC 4180; a text that a spreadsheet would take for a formula begins with an apostrophe.
std::string Cell(const std::string& text) {
  std::string cell = text;
  if (!cell.empty() && std::string_view("=+-@").find(cell.front()) != std::string_view::npos) {
    cell.insert(0, 1, '\'');
  }
  if (cell.find_first_of(",\"\r\n") == std::string::npos) return cell;
  std::string quoted = "\"";
  for (const char each : cell) quoted += each == '"' ? std::string("\"\"") : std::string(1, each);
  return quoted + '"';
}

std::string CsvOf(const Store& store, const std::vector<std::string>& machines) {
  std::string text = "machine,campaign,measured,figure,conditions,value,u,coverage,unit\n";
  for (const std::string& machine : machines) {
    for (const auto& point : store.PointsOf(machine, "", "")) {
      const auto& figure = point.figure;
      text += fmt::format("{},{},{},{},{},{},{},{},{}\n", Cell(machine), point.campaign,
                          recording::InstantText(point.measured), Cell(figure.Name()),
                          Cell(figure.conditions), figure.value,
                          figure.u ? fmt::format("{}", *figure.u) : "", figure.coverage,
                          QuantityUnit(figure.quantity));
    }
  }
  return text;
}

int Export(const HistoryOptions& options) {
  HistoryOptions silent = options;
  silent.quiet = true;  // standard output is for the data
  const Store store = Open(silent, Store::Missing::kRefuse);
  std::string text;
  if (options.format == "csv") {
    text = CsvOf(store, options.machine.empty() ? store.Machines()
                                                : std::vector<std::string>{options.machine});
  } else {
    ordered_json all = CampaignsJson({});
    for (const auto& head : store.List(options.machine)) {
      all["campaigns"].push_back(CampaignJson(store.Read(head.id)));
    }
    text = all.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';
  }
  if (options.out.empty()) {
    fmt::print("{}", text);
  } else {
    WriteText(text, options.out);
  }
  return kDone;
}

// The subcommands ---------------------------------------------------------------------------------

class Subcommands {
 public:
  Subcommands(CLI::App& history, int& exit_code)
      : history_(history), exit_code_(exit_code), options_(std::make_shared<HistoryOptions>()) {}

  CLI::App* Make(const char* name, const char* about, const char* example,
                 int (*run)(const HistoryOptions&)) {
    CLI::App* command = history_.add_subcommand(name, about);
    command->add_option("--store", options_->store,
                        "File, or postgresql://... (default: history.db of the user's data)");
    command->footer(std::string("Example: ") + example);
    command->callback(
        [options = options_, &exit_code = exit_code_, run] { exit_code = run(*options); });
    return command;
  }

  void WithJson(CLI::App* command) {
    command->add_option("--json", options_->json, "File for the result as data");
    command->add_flag("--quiet", options_->quiet, "No table");
  }
  void WithMachine(CLI::App* command) {
    command->add_option("--machine", options_->machine, "Name of the machine");
  }
  HistoryOptions& options() { return *options_; }

 private:
  CLI::App& history_;
  int& exit_code_;
  std::shared_ptr<HistoryOptions> options_;
};

void AddKeeping(Subcommands& sub) {
  HistoryOptions& options = sub.options();
  CLI::App* add =
      sub.Make("add", "Keep a campaign: a folder, or files",
               "abbe history add measured --machine mill.toml --note \"after service\"", Add);
  add->add_option("from", options.from,
                  "Folders (a campaign each), or results, recordings and maps (one campaign)")
      ->required();
  add->add_option("--machine", options.machine_file, "Machine file, kept with the campaign");
  add->add_option("--note", options.note, "What the campaign was for");
  add->add_option("--operator", options.who, "Who measured (default: as the results say)");
  add->add_option("--measured", options.measured,
                  "When, as 2026-11-21T09:00:00Z (default: as the results say)");
  add->add_option("--instrument", options.instruments,
                  "ROLE=NAME, for example head=P-12, target=T-3, length=IF-7; repeatable")
      ->allow_extra_args(false);
  add->add_flag("--quiet", options.quiet, "Print nothing but warnings");

  CLI::App* list = sub.Make("list", "The campaigns", "abbe history list --machine mill", List);
  sub.WithMachine(list);
  sub.WithJson(list);

  CLI::App* show =
      sub.Make("show", "One campaign with its figures", "abbe history show 3", ShowCampaign);
  show->add_option("campaign", options.campaign, "Its number, or latest")->required();
  sub.WithMachine(show);
  sub.WithJson(show);

  CLI::App* forget = sub.Make("forget", "Take a campaign out", "abbe history forget 3", Forget);
  forget->add_option("campaign", options.campaign, "Its number, or latest")->required();
  sub.WithMachine(forget);
  forget->add_flag("--quiet", options.quiet, "Print nothing");

  CLI::App* out = sub.Make("export", "All figures as a table, or everything as JSON",
                           "abbe history export --format csv --out figures.csv", Export);
  out->add_option("--format", options.format, "csv: the figures; json: all that is kept")
      ->check(CLI::IsMember({"csv", "json"}))
      ->capture_default_str();
  sub.WithMachine(out);
  out->add_option("--out", options.out, "File (default: standard output)");
}

void AddJudging(Subcommands& sub) {
  HistoryOptions& options = sub.options();
  CLI::App* compare = sub.Make("compare", "What changed between two campaigns",
                               "abbe history compare 3 latest --json compare.json", Compare);
  compare->add_option("before", options.campaign, "Number of a campaign, or latest")->required();
  compare->add_option("after", options.other, "Number of another")->required();
  compare->add_option("--level", options.level, "Chance of any false alarm among all differences")
      ->check(CLI::Range(1e-6, 0.5))
      ->capture_default_str();
  sub.WithMachine(compare);
  sub.WithJson(compare);

  CLI::App* trend = sub.Make("trend", "A figure over time, and when it meets its limit",
                             "abbe history trend EYX --machine mill", Trend);
  trend->add_option("figure", options.figure, "EYX, straightness_um or EYX.straightness_um")
      ->required();
  sub.WithMachine(trend);
  sub.WithJson(trend);

  CLI::App* check = sub.Make("check", "Figures against the limits of the machine file",
                             "abbe history check measured --machine mill.toml", Check);
  check->add_option("of", options.campaign, "A folder with results, or a campaign of the history")
      ->required();
  check->add_option("--machine", options.machine_file, "Machine file with [limits]")->required();
  check->add_flag("--proven", options.proven, "Exit code 1 unless every limit is proven to be met");
  sub.WithJson(check);
}

}  // namespace

void AddHistory(CLI::App& program, int& exit_code) {
  CLI::App* history = program.add_subcommand(
      "history", "The history of machines: keep, compare, follow and check campaigns");
  history->require_subcommand(1);
  history->footer(
      "Example: abbe history add measured --machine mill.toml\n"
      "         abbe history trend EYX --machine mill");
  Subcommands sub(*history, exit_code);
  AddKeeping(sub);
  AddJudging(sub);
}

}  // namespace abbe::apps
