// The options of `abbe history` and its subcommands: one function each, which reads the options,
// calls the library, prints, and returns the exit code.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "history/comparison.h"
#include "history/limits.h"
#include "history/store.h"

namespace abbe::apps {

struct HistoryOptions {
  std::string store;
  std::vector<std::filesystem::path> from;
  std::filesystem::path machine_file, json, out;
  std::string who, note, measured, machine, campaign, other, figure, format = "csv";
  std::vector<std::string> instruments;
  double level = history::kFamilyLevel;
  bool quiet = false, proven = false;
};

// Seconds since 1970.
double SecondsNow();

// Opens the store of --store, or that of the user, whose place is printed.
history::Store OpenStore(const HistoryOptions& options, history::Store::Missing missing);

// A number, or "latest" of a machine (an empty one: of all).
long long CampaignNumber(const std::string& text, const std::string& machine,
                         const history::Store& store);

// Unless --quiet; with --json.
void ShowHistory(const HistoryOptions& options, const std::string& text);
void KeepHistory(const HistoryOptions& options, const nlohmann::ordered_json& result);

int AddCampaigns(const HistoryOptions& options);
int ListCampaigns(const HistoryOptions& options);
int ShowCampaign(const HistoryOptions& options);
int ForgetCampaign(const HistoryOptions& options);
int ExportHistory(const HistoryOptions& options);

int CompareCampaigns(const HistoryOptions& options);
int FollowFigures(const HistoryOptions& options);
int CheckLimits(const HistoryOptions& options);

}  // namespace abbe::apps
