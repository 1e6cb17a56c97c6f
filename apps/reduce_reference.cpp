#include "apps/reduce_reference.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "recording/made_on.h"
#include "recording/started.h"
#include "settings/unit.h"
#include "standards/positioning.h"

namespace abbe::apps {
namespace {

using nlohmann::ordered_json;
using recording::Recording;

// The axis in the header, else the only one with a reference column: 'x', 'y' or 'z'.
char AxisOf(const Recording& recording) {
  const std::optional<std::string> named = recording.HeaderText("axis");
  if (named) {
    if (*named == "X" || *named == "Y" || *named == "Z")
      return static_cast<char>((*named)[0] - 'A' + 'a');
    throw InputError(
        fmt::format("{}: axis = \"{}\": positioning is evaluated along one axis, X, Y or Z",
                    recording.name, *named));
  }
  std::string found;
  for (const char axis : {'x', 'y', 'z'}) {
    if (recording.Find(fmt::format("ref_{}_mm", axis))) found += axis;
  }
  if (found.size() == 1) return found[0];
  throw InputError(
      fmt::format("{}: {} reference columns: name the moving axis in the header, axis = \"X\"",
                  recording.name, found.size()));
}

struct Sum {
  double total = 0.0;
  int count = 0;
};
using ByPass = std::map<double, Sum>;

struct Readings {
  double target = 0.0;  // m
  ByPass up, down;
};

struct GroupedReadings {
  std::map<long long, Readings> by_nanometre;
  std::size_t left_out = 0;
};

GroupedReadings Group(const Recording& recording, char axis) {
  const auto target = recording.At(fmt::format("{}_mm", axis));
  const auto reference = recording.At(fmt::format("ref_{}_mm", axis));
  const auto pass = recording.At("pass"), direction = recording.At("direction");
  const auto flags = recording.Find("flags");
  GroupedReadings grouped;
  for (std::size_t row = 0; row < recording.rows(); ++row) {
    if (flags && (*flags)[row] != 0) {
      ++grouped.left_out;
      continue;
    }
    if (direction[row] != 1 && direction[row] != -1) {
      throw InputError(fmt::format(
          "{}: row {} has direction {}: each reading needs the direction of its approach, 1 or -1",
          recording.name, row + 1, direction[row]));
    }
    const double position = target[row] * settings::kMillimetre;
    auto& readings = grouped.by_nanometre[std::llround(position / settings::kNanometre)];
    readings.target = position;
    Sum& sum = (direction[row] > 0 ? readings.up : readings.down)[pass[row]];
    sum.total += (reference[row] - target[row]) * settings::kMillimetre;
    ++sum.count;
  }
  return grouped;
}

std::vector<double> Means(const ByPass& passes) {
  std::vector<double> means;
  means.reserve(passes.size());
  for (const auto& [pass, sum] : passes) means.push_back(sum.total / sum.count);
  return means;
}

double Micrometres(double metres) { return metres / settings::kMicrometre; }

ordered_json TargetJson(const standards::TargetFigures& target) {
  return {{"target_mm", target.target / settings::kMillimetre},
          {"mean_up_um", Micrometres(target.mean_up)},
          {"mean_down_um", Micrometres(target.mean_down)},
          {"mean_um", Micrometres(target.mean)},
          {"reversal_um", Micrometres(target.reversal)},
          {"std_up_um", Micrometres(target.std_up)},
          {"std_down_um", Micrometres(target.std_down)},
          {"R_up_um", Micrometres(target.repeatability_up)},
          {"R_down_um", Micrometres(target.repeatability_down)},
          {"R_um", Micrometres(target.repeatability)}};
}

ordered_json FiguresJson(const standards::Positioning& figures) {
  return {{"A_um", Micrometres(figures.accuracy)},
          {"A_up_um", Micrometres(figures.accuracy_up)},
          {"A_down_um", Micrometres(figures.accuracy_down)},
          {"R_um", Micrometres(figures.repeatability)},
          {"R_up_um", Micrometres(figures.repeatability_up)},
          {"R_down_um", Micrometres(figures.repeatability_down)},
          {"E_um", Micrometres(figures.systematic)},
          {"E_up_um", Micrometres(figures.systematic_up)},
          {"E_down_um", Micrometres(figures.systematic_down)},
          {"M_um", Micrometres(figures.mean_range)},
          {"B_um", Micrometres(figures.reversal)},
          {"mean_reversal_um", Micrometres(figures.mean_reversal)}};
}

}  // namespace

ordered_json ReduceReference(const Recording& recording) {
  recording::RefuseOtherKind(recording, "reference", "ISO 230-2 figures are those of its targets");
  const char axis = AxisOf(recording);
  const GroupedReadings grouped = Group(recording, axis);
  std::vector<standards::TargetDeviations> deviations;
  for (const auto& [nanometre, readings] : grouped.by_nanometre) {
    deviations.push_back({readings.target, Means(readings.up), Means(readings.down)});
  }
  ordered_json iso230_2;
  try {
    const standards::Positioning figures = standards::EvaluatePositioning(deviations);
    iso230_2 = FiguresJson(figures);
    iso230_2["cycles"] = deviations.front().up.size();
    iso230_2["left_out_rows"] = grouped.left_out;
    for (const auto& target : figures.targets) iso230_2["targets"].push_back(TargetJson(target));
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", recording.name, error.what()));
  }
  ordered_json result{{"abbe", ABBE_VERSION}, {"command", "reduce"}, {"kind", "reference"}};
  if (const auto machine = recording.HeaderText("machine")) result["machine"] = *machine;
  if (const auto started = recording::StartedText(recording); !started.empty()) {
    result["started"] = started;
  }
  result["axis"] = std::string(1, static_cast<char>(axis - 'a' + 'A'));
  result["iso230_2"] = std::move(iso230_2);
  return result;
}

std::string ReferenceTable(const ordered_json& result) {
  const ordered_json& figures = result["iso230_2"];
  const auto um = [](const ordered_json& from, const char* key) { return from[key].get<double>(); };
  std::string text = fmt::format("ISO 230-2, axis {}: {} targets, {} cycles in both directions\n\n",
                                 result["axis"].get<std::string>(), figures["targets"].size(),
                                 figures["cycles"].get<int>());
  text += fmt::format("{:>12} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10}\n", "target [mm]",
                      "up [um]", "down [um]", "B_i [um]", "R_i up", "R_i down", "R_i [um]");
  for (const ordered_json& target : figures["targets"]) {
    text += fmt::format("{:12.4f} {:10.2f} {:10.2f} {:10.2f} {:10.2f} {:10.2f} {:10.2f}\n",
                        um(target, "target_mm"), um(target, "mean_up_um"),
                        um(target, "mean_down_um"), um(target, "reversal_um"),
                        um(target, "R_up_um"), um(target, "R_down_um"), um(target, "R_um"));
  }
  text += fmt::format("\n{:<34} {:>10} {:>10} {:>10}\n", "[um]", "both", "up", "down");
  for (const auto& [name, symbol] :
       {std::pair{"accuracy A", "A"}, std::pair{"repeatability R", "R"},
        std::pair{"systematic deviation E", "E"}}) {
    text += fmt::format("{:<34} {:10.2f} {:10.2f} {:10.2f}\n", name,
                        um(figures, fmt::format("{}_um", symbol).c_str()),
                        um(figures, fmt::format("{}_up_um", symbol).c_str()),
                        um(figures, fmt::format("{}_down_um", symbol).c_str()));
  }
  text += fmt::format("{:<34} {:10.2f}\n", "range of the mean deviation M", um(figures, "M_um"));
  text += fmt::format("{:<34} {:10.2f}\n", "largest reversal B", um(figures, "B_um"));
  text += fmt::format("{:<34} {:10.2f}\n", "mean reversal (up - down)",
                      um(figures, "mean_reversal_um"));
  if (const auto left_out = figures["left_out_rows"].get<std::size_t>(); left_out > 0) {
    text += fmt::format("{} flagged rows were left out\n", left_out);
  }
  if (figures["cycles"].get<int>() < 5)
    text += "fewer than the five cycles that ISO 230-2 asks for\n";
  return text;
}

}  // namespace abbe::apps
