// What keeps campaigns: abbe history add, list, show, forget, export.
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
#include "recording/instant.h"

namespace abbe::apps {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

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
                                  .now = SecondsNow()};
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

std::string CsvOf(const history::Store& store, const std::vector<std::string>& machines) {
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

}  // namespace

// Each folder is a campaign; single files together are one.
int AddCampaigns(const HistoryOptions& options) {
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
  std::optional<history::Store> store;
  if (!options.machine_file.empty()) {
    history::ReadLimits(settings::Document::Read(options.machine_file).Root());
  }
  for (const auto& group : groups) {
    const history::Campaign campaign = history::ReadCampaign(group, campaign_options);
    for (const std::string& note : campaign.notes) fmt::print(stderr, "abbe: {}\n", note);
    if (!store) store.emplace(OpenStore(options, history::Store::Missing::kMake));
    ShowHistory(options, AddedText(store->Add(campaign, SecondsNow()), campaign));
    std::fflush(stdout);  // what is said is stored
  }
  return kDone;
}

int ListCampaigns(const HistoryOptions& options) {
  const history::Store store = OpenStore(options, history::Store::Missing::kRefuse);
  const auto campaigns = store.List(options.machine);
  ShowHistory(options, CampaignTable(campaigns));
  KeepHistory(options, CampaignsJson(campaigns));
  return kDone;
}

int ShowCampaign(const HistoryOptions& options) {
  const history::Store store = OpenStore(options, history::Store::Missing::kRefuse);
  const auto campaign = store.Read(CampaignNumber(options.campaign, options.machine, store));
  ShowHistory(options, CampaignText(campaign));
  KeepHistory(options, CampaignJson(campaign));
  return kDone;
}

int ForgetCampaign(const HistoryOptions& options) {
  history::Store store = OpenStore(options, history::Store::Missing::kRefuse);
  const long long campaign = CampaignNumber(options.campaign, options.machine, store);
  store.Forget(campaign);
  ShowHistory(options, fmt::format("campaign {} is forgotten; its recordings stay where they are\n",
                                   campaign));
  return kDone;
}

int ExportHistory(const HistoryOptions& options) {
  HistoryOptions silent = options;
  silent.quiet = true;  // standard output is for the data
  const history::Store store = OpenStore(silent, history::Store::Missing::kRefuse);
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

}  // namespace abbe::apps
