#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <map>

#include "hal/recorder.h"
#include "hal/sweep_recorder.h"
#include "settings/toml_text.h"
#include "settings/unit.h"

namespace abbe::hal {
namespace {

using settings::kMicrometre;
using settings::kMillimetre;
using settings::Quoted;

// Columns that every sweep has, with or without a channel of a device.
const std::vector<std::string> kOfSweep = {"time_s", "x_mm",      "y_mm",       "z_mm",
                                           "pass",   "direction", "feed_mm_min"};

// The table [sources]: the description and the channels of each device.
std::string SourcesText(const std::vector<Channel>& channels,
                        const std::map<std::string, std::string>& transport) {
  std::map<std::string, std::string> by_device;
  for (const Channel& channel : channels) {
    std::string& names = by_device[channel.device];
    names += (names.empty() ? "" : ", ") + channel.name;
  }
  std::string text = "[sources]\n";
  for (const auto& [device, names] : by_device) {
    text += fmt::format("{} = {}\n", Quoted(device), Quoted(transport.at(device) + ": " + names));
  }
  return text;
}

// Readings of a device that identifies itself as simulated are marked so in every result.
std::string SimulatedText(const std::map<std::string, std::string>& transport) {
  const auto says = [](const auto& one) {
    return one.second.find("simulated") != std::string::npos;
  };
  return std::ranges::any_of(transport, says) ? "simulated = true\n" : "";
}

}  // namespace

std::vector<std::string> SweepColumns(const std::vector<Channel>& channels) {
  std::vector<std::string> columns = kOfSweep;
  for (const Channel& channel : channels) {
    if (std::ranges::find(kOfSweep, channel.name) == kOfSweep.end()) {
      columns.push_back(channel.name);
    }
  }
  columns.push_back("flags");
  return columns;
}

std::string SweepHeader(const SweepPlan& plan, const SweepAbout& about,
                        const std::vector<Channel>& channels) {
  std::map<std::string, std::string> transport = about.transport;
  for (const Channel& channel : channels) transport.try_emplace(channel.device, about.source);
  std::string text = fmt::format("kind = \"sweep\"\nmachine = {}\naxis = \"{:c}\"\nstarted = {}\n",
                                 Quoted(about.machine), plan.axis, about.started);
  text += SimulatedText(transport) + SourcesText(channels, transport);
  std::string stations;
  for (const double station : plan.stations) {
    stations += fmt::format("{}{:.9g}", stations.empty() ? "" : ", ", station / kMillimetre);
  }
  text += fmt::format(
      "[sweep]\nstations_mm = [{}]\npasses = {}\ndwell_s = {:.9g}\nsettle_s = {:.9g}\n"
      "window_um = {:.9g}\nfeed_mm_min = {:.9g}\noverrun_mm = {:.9g}\n",
      stations, plan.passes, plan.dwell, plan.settle, plan.window / kMicrometre,
      plan.feed / settings::UnitOf("feed_mm_min").si, plan.overrun / kMillimetre);
  if (!about.mounting.empty()) text += fmt::format("[mounting]\nid = {}\n", Quoted(about.mounting));
  return text + about.more;
}

std::string KindOf(const std::vector<Channel>& channels) {
  const auto has = [&](const char* name) {
    return std::any_of(channels.begin(), channels.end(),
                       [name](const Channel& channel) { return channel.name == name; });
  };
  if (has("pivot_1_rad") && has("x_mm") && has("y_mm") && has("z_mm")) return "linkage";
  const bool axis = has("x_mm") || has("y_mm") || has("z_mm");
  return axis && (has("ref_x_mm") || has("ref_y_mm") || has("ref_z_mm")) ? "reference" : "dwell";
}

std::vector<std::string> RecordColumns(const std::vector<Channel>& channels) {
  std::vector<std::string> columns = {"time_s"};
  for (const Channel& channel : channels) columns.push_back(channel.name);
  columns.insert(columns.end(), {"skew_ms", "flags"});
  return columns;
}

std::string RecordHeader(const RecordAbout& about, const std::vector<Channel>& channels) {
  return fmt::format("kind = \"{}\"\nmachine = {}\nstarted = {}\n", KindOf(channels),
                     Quoted(about.machine), about.started) +
         SimulatedText(about.transport) + SourcesText(channels, about.transport);
}

}  // namespace abbe::hal
