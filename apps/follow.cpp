// abbe follow: how a recorded number follows the temperatures beside it, with which lags.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/commands.h"
#include "apps/conditions.h"
#include "apps/machine_recording.h"
#include "apps/result_file.h"
#include "apps/rounded.h"
#include "standards/coverage.h"
#include "track/series.h"

namespace abbe::apps {
namespace {

constexpr std::size_t kBlock = 20;  // rows

struct FollowArguments {
  std::filesystem::path recording, json;
  std::string value;
  std::vector<std::string> sensors;
  bool quiet = false;
};

track::Series SeriesOf(const FollowArguments& arguments) {
  const recording::Recording recording = ReadWithWarnings(arguments.recording);
  std::vector<std::string> sensors = arguments.sensors;
  if (sensors.empty()) {
    for (const auto& column : recording.columns) {
      const std::string sensor = SensorOf(column.name);
      if (!sensor.empty()) sensors.push_back(sensor);
    }
  }
  if (sensors.empty()) {
    throw InputError(fmt::format("{}: has no column temp_NAME_c to follow", recording.name));
  }
  const auto time = recording.At("time_s"), value = recording.At(arguments.value);
  const auto flags = recording.Find("flags");
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < recording.rows(); ++row) {
    if (std::isfinite(value[row]) && (!flags || (*flags)[row] == 0.0)) rows.push_back(row);
  }
  const auto count = std::ssize(rows);
  track::Series series{.name = recording.name,
                       .time = Eigen::VectorXd(count),
                       .value = Eigen::VectorXd(count),
                       .sensors = sensors,
                       .temperature = Eigen::MatrixXd(std::ssize(sensors), count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    series.time[i] = time[rows[i]];
    series.value[i] = value[rows[i]];
  }
  for (std::size_t s = 0; s < sensors.size(); ++s) {
    const auto column = recording.At(fmt::format("temp_{}_c", sensors[s]));
    for (Eigen::Index i = 0; i < count; ++i) {
      series.temperature(static_cast<Eigen::Index>(s), i) = column[rows[i]];
    }
  }
  return series;
}

struct HeldOutRows {
  double rms = 0.0, inside = 0.0;
};

// Every second block of rows, by a response that was learned without them.
HeldOutRows PredictBlocks(const track::Series& series) {
  std::vector<bool> held_out(series.value.size());
  for (std::size_t row = 0; row < held_out.size(); ++row) held_out[row] = row / kBlock % 2 == 1;
  const track::SeriesResponse response = track::LearnResponse(series, held_out);
  HeldOutRows found;
  double count = 0.0;
  for (std::size_t row = 0; row < held_out.size(); ++row) {
    if (!held_out[row]) continue;
    const auto i = static_cast<Eigen::Index>(row);
    const double off = response.value[i] - series.value[i];
    found.rms += off * off;
    found.inside += std::abs(off) < standards::kCoverage * response.u[i] ? 1.0 : 0.0;
    count += 1.0;
  }
  if (count == 0.0) return {};
  return {std::sqrt(found.rms / count), found.inside / count};
}

int Follow(const FollowArguments& arguments) {
  const track::Series series = SeriesOf(arguments);
  const track::SeriesResponse response = track::LearnResponse(series, {});
  const HeldOutRows held_out = PredictBlocks(series);
  nlohmann::ordered_json json{
      {"abbe", ABBE_VERSION},        {"command", "follow"},
      {"recording", series.name},    {"value", arguments.value},
      {"rows", series.value.size()}, {"sensors", nlohmann::ordered_json::array()}};
  std::string text = fmt::format("{} follows\n{:<16}{:>20}{:>12}{:>18}\n", arguments.value,
                                 "sensor", "for each kelvin", "lag, s", "95 %");
  for (const track::SeriesSensor& each : response.sensors) {
    const double U = standards::kCoverage * each.u_gain;
    text += fmt::format("{:<16}{:>20}{:>12.0f}{:>18}\n", each.sensor, PlusMinus(each.gain, U),
                        each.lag, fmt::format("{:.0f} to {:.0f}", each.shortest, each.longest));
    if (!each.lag_seen) {
      text += fmt::format(
          "{:<16}its lag is as long or short as was sought: the recording does not tell it\n", "");
    }
    json["sensors"].push_back({{"sensor", each.sensor},
                               {"gain_per_c", each.gain},
                               {"U95_per_c", U},
                               {"lag_s", each.lag},
                               {"lag_from_s", each.shortest},
                               {"lag_to_s", each.longest},
                               {"lag_seen", each.lag_seen}});
  }
  text += fmt::format(
      "beside that it wanders by {:.3g} in an hour, and each row scatters by {:.3g}\n"
      "rows held out in blocks of {}: {:.3g} rms, {:.1f} % within U95\n",
      response.walk, response.noise, kBlock, held_out.rms, 100.0 * held_out.inside);
  json["walk_after_an_hour"] = response.walk;
  json["noise"] = response.noise;
  json["held_out"] = {{"rms", held_out.rms}, {"within_U95", held_out.inside}};
  if (!arguments.json.empty()) WriteResult(json, arguments.json);
  if (!arguments.quiet) fmt::print("{}", text);
  return kDone;
}

}  // namespace

void AddFollow(CLI::App& program, int& exit_code) {
  auto arguments = std::make_shared<FollowArguments>();
  CLI::App* command = program.add_subcommand(
      "follow", "How a recorded number follows the temperatures beside it, with which lags");
  command->add_option("recording", arguments->recording, "Recording with columns temp_NAME_c")
      ->required();
  command->add_option("--value", arguments->value, "The column that follows, such as probe_a_um")
      ->required();
  command->add_option("--sensor", arguments->sensors, "NAME of a temperature (all)");
  command->add_option("--json", arguments->json, "File for the result as data");
  command->add_flag("--quiet", arguments->quiet, "No table");
  command->footer("Example: abbe follow warm_up.csv --value probe_a_um --sensor column");
  command->callback([arguments, &exit_code] { exit_code = Follow(*arguments); });
}

}  // namespace abbe::apps
