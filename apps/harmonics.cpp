// abbe harmonics: the run-out of a turning shaft, from a recording of probes and an angle.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/commands.h"
#include "apps/machine_recording.h"
#include "apps/result_file.h"
#include "fusion/bearing_harmonics.h"
#include "paths/shaft_readings.h"
#include "settings/unit.h"

namespace abbe::apps {
namespace {

using fusion::BearingHarmonics;
using nlohmann::ordered_json;

struct HarmonicsArguments {
  std::filesystem::path recording, json;
  std::string angle;
  std::vector<std::string> columns;
  int orders = 2;
  bool quiet = false;
};

// The printed unit of a column, and the ending of its keys in the result: lengths in um, angles in
// urad, all else in the unit of the column (a voltage in V, "_v").
struct ColumnUnit {
  std::string unit, ending;
  double si;
};

ColumnUnit ColumnUnitOf(const std::string& column) {
  const settings::Unit unit = settings::UnitOf(column);
  for (const char* const ending : {"_mm", "_um", "_nm", "_m"}) {
    if (unit.name == settings::UnitOf(ending).name) return {"um", "_um", settings::kMicrometre};
  }
  for (const char* const ending : {"_deg", "_rad", "_mrad", "_urad"}) {
    if (unit.name == settings::UnitOf(ending).name)
      return {"urad", "_urad", settings::kMicroradian};
  }
  return {std::string(unit.name), column.substr(settings::StemOf(column).size()), unit.si};
}

// Rms of later readings about a fit of the earlier ones, without harmonics and with all of them.
struct HeldOut {
  double without, with;
};

HeldOut SecondHalf(const paths::ShaftReadings& shaft, const std::vector<int>& orders) {
  const std::size_t half = shaft.value.size() / 2;
  const std::span angle(shaft.angle), value(shaft.value);
  const auto rms = [&](const std::vector<int>& of) {
    const BearingHarmonics first = fusion::FitBearing(angle.first(half), value.first(half), of);
    return fusion::RmsAbout(first, angle.subspan(half), value.subspan(half));
  };
  return {rms({}), rms(orders)};
}

ordered_json ChannelJson(const std::string& column, const paths::ShaftReadings& shaft,
                         const std::vector<int>& orders) {
  const ColumnUnit column_unit = ColumnUnitOf(column);
  const auto key = [&](const char* what) { return what + column_unit.ending; };
  const auto value = [&](double si) { return si / column_unit.si; };
  const BearingHarmonics fit = fusion::FitBearing(shaft.angle, shaft.value, orders, shaft.time);
  const HeldOut held_out = SecondHalf(shaft, orders);
  ordered_json harmonics = ordered_json::array();
  for (const int order : orders) {
    const auto entry = [&](const char* wave) {
      return fmt::format("bearing.shaft_{}_{}", wave, order);
    };
    harmonics.push_back({{"order", order},
                         {key("sin"), value(fit.result.Value(entry("sin")))},
                         {key("cos"), value(fit.result.Value(entry("cos")))},
                         {key("amplitude"), value(fit.Amplitude(order))},
                         {key("u"), value(fit.result.Uncertainty(entry("sin")))}});
  }
  ordered_json channel{{"column", column},
                       {"unit", column_unit.unit},
                       {"readings", shaft.value.size()},
                       {key("mean"), value(fit.result.Value("mean.gap"))},
                       {"harmonics", harmonics},
                       {key("rms"), value(fit.rms)},
                       {key("held_out_rms"), value(held_out.with)},
                       {key("held_out_rms_without"), value(held_out.without)}};
  if (fit.memory) {
    channel[key("remembered")] = value(fit.memory->slow);
    channel["remembered_s"] = fit.memory->time;
  }
  return channel;
}

std::string ChannelTable(const ordered_json& channel) {
  const std::string unit = channel["unit"].get<std::string>();
  const std::string ending = ColumnUnitOf(channel["column"].get<std::string>()).ending;
  const auto number = [&](const ordered_json& of, const char* what) {
    return of[what + ending].get<double>();
  };
  std::string text = fmt::format(
      "\n{}: {} readings, {}\n{:>8}{:>12}{:>12}{:>14}{:>10}\n",
      channel["column"].get<std::string>(), channel["readings"].get<std::size_t>(),
      unit.empty() ? "as they are" : "in " + unit, "order", "sin", "cos", "amplitude", "u");
  for (const ordered_json& one : channel["harmonics"]) {
    text += fmt::format("{:>8}{:>12.3f}{:>12.3f}{:>14.3f}{:>10.3f}\n", one["order"].get<int>(),
                        number(one, "sin"), number(one, "cos"), number(one, "amplitude"),
                        number(one, "u"));
  }
  text += fmt::format(
      "residuals {:.2f} {} rms; the second half by a fit of the first: {:.2f} {}, without "
      "harmonics {:.2f} {}\n",
      number(channel, "rms"), unit, number(channel, "held_out_rms"), unit,
      number(channel, "held_out_rms_without"), unit);
  if (channel.contains("remembered_s")) {
    text += fmt::format("of the residuals {:.2f} {} go on for {:.2g} s; u counts it\n",
                        number(channel, "remembered"), unit, channel["remembered_s"].get<double>());
  }
  return text;
}

int Harmonics(const HarmonicsArguments& arguments) {
  const recording::Recording recording = ReadWithWarnings(arguments.recording);
  std::vector<int> orders(arguments.orders);
  std::iota(orders.begin(), orders.end(), 1);
  ordered_json result{{"abbe", ABBE_VERSION},     {"command", "harmonics"},
                      {"kind", "harmonics"},      {"recording", recording.name},
                      {"angle", arguments.angle}, {"channels", ordered_json::array()}};
  for (const std::string& column : arguments.columns) {
    const auto shaft = paths::ReadShaft(recording, arguments.angle, column);
    result["channels"].push_back(ChannelJson(column, shaft, orders));
    if (!arguments.quiet) fmt::print("{}", ChannelTable(result["channels"].back()));
  }
  if (!arguments.json.empty()) WriteResult(result, arguments.json);
  return kDone;
}

}  // namespace

void AddHarmonics(CLI::App& program, int& exit_code) {
  auto arguments = std::make_shared<HarmonicsArguments>();
  CLI::App* command =
      program.add_subcommand("harmonics", "Run-out of a turning shaft: eccentricity and lobes");
  command->add_option("recording", arguments->recording, "A recording of probes and an angle")
      ->required();
  command->add_option("--angle", arguments->angle, "Column of the shaft's angle (..._deg)")
      ->required();
  command->add_option("--of", arguments->columns, "Columns of the probes, with commas between")
      ->delimiter(',')
      ->required();
  command->add_option("--orders", arguments->orders, "Harmonics 1 to N")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command->add_option("--json", arguments->json, "File for the result as data");
  command->add_flag("--quiet", arguments->quiet, "No table");
  command->footer("Example: abbe harmonics turn.csv --angle shaft_deg --of gap_1_mm,gap_2_mm");
  command->callback([arguments, &exit_code] { exit_code = Harmonics(*arguments); });
}

}  // namespace abbe::apps
