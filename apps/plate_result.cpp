#include "apps/plate_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "apps/fuse_result.h"
#include "settings/unit.h"

namespace abbe::apps {
namespace {

using Eigen::VectorXd;
using nlohmann::ordered_json;

using settings::kMicro;
using settings::kMillimetre;
constexpr Eigen::Index kStations = 13;
constexpr int kMotionErrors = machine::kAxes * machine::kMotions;

VectorXd StationsOf(const PlateResult& result, int error) {
  if (error >= kMotionErrors) return VectorXd::Zero(1);
  const std::size_t axis = error / machine::kMotions;
  const auto& travel = result.fused.map.model().travels()[axis];
  return VectorXd::LinSpaced(kStations, travel.first, travel.last);
}

std::string ErrorTable(const PlateResult& result) {
  std::string text =
      fmt::format("{:<7}{:>10}{:>10}  {:<6}{}\n", "error", "largest", "u", "unit", "determined by");
  for (int error = 0; error < kMotionErrors; ++error) {
    const auto& seen = result.fused.functions[error];
    const VectorXd value = result.fused.map.CurveOf(error, StationsOf(result, error)).value;
    Eigen::Index at = 0;
    value.cwiseAbs().maxCoeff(&at);
    text += fmt::format("{:<7}{:>+10.3f}{:>10.3f}  {:<6}{}\n", seen.name, value[at] / kMicro,
                        seen.u / kMicro, seen.name[1] >= 'X' ? "um" : "urad", DeterminedBy(seen));
  }
  return text;
}

std::string SquarenessTable(const PlateResult& result) {
  std::string text =
      fmt::format("\n{:<11}{:>10}{:>10}  {:<6}{:>15}{:>10}  {:<16}{}\n", "squareness", "value", "u",
                  "unit", "by diagonals", "u", "set-ups", "determined by");
  for (std::size_t k = 0; k < result.diagonals.size(); ++k) {
    const auto& seen = result.fused.functions[kMotionErrors + k];
    const auto& by = result.diagonals[k];
    text += fmt::format("{:<11}{:>+10.3f}{:>10.3f}  {:<6}{:>15}{:>10}  {:<16}{}\n", seen.name,
                        result.fused.map.model().squareness()[k] / kMicro, seen.u / kMicro, "urad",
                        by.setups == 0 ? "-" : fmt::format("{:+.3f}", by.value / kMicro),
                        by.setups == 0 ? "-" : fmt::format("{:.3f}", by.u / kMicro), by.setups,
                        DeterminedBy(seen));
  }
  return text;
}

std::string InterpolatorTable(const PlateResult& result) {
  if (result.interpolators.empty()) return "";
  std::string text = fmt::format("\n{:<20}{:>16}{:>18}{:>10}{:>9}\n", "interpolation",
                                 "held out, um", "at stations, um", "neurons", "cycles");
  for (const auto& each : result.interpolators) {
    const bool learned = each.learning.neurons > 0;
    text += fmt::format("{:<20}{:>16.3f}{:>18}{:>10}{:>9}\n", each.name, each.held_out / kMicro,
                        learned ? fmt::format("{:.3f}", each.learning.rms / kMicro) : "-",
                        learned ? fmt::format("{}", each.learning.neurons) : "-",
                        learned ? fmt::format("{}", each.learning.cycles) : "-");
  }
  return text;
}

std::string SpecimenTable(const PlateResult& result) {
  if (result.specimen.empty()) return "";
  std::string text = fmt::format("\n{:<10}{:>14}{:>14}{:>14}{:>12}\n", "specimen", "length mm",
                                 "before mm", "after mm", "u(map) um");
  for (const auto& each : result.specimen) {
    text += fmt::format("row {:<6}{:>14.4f}{:>14.4f}{:>14.4f}{:>12.3f}\n", each.row + 1,
                        each.length / kMillimetre, each.before / kMillimetre,
                        each.after / kMillimetre, each.u / kMicro);
  }
  return text;
}

// A hole that is wrong in all set-ups has one line.
std::string WrongHolesText(const PlateResult& result) {
  std::string text;
  std::set<int> told;
  for (const fusion::WrongHole& each : result.wrong_holes) {
    if (each.anywhere && !told.insert(each.hole).second) continue;
    text += fmt::format(
        "\nWRONG HOLE: hole {} {} is off by {:+.3g}, {:+.3g} um in the plate, {:.2g} times its "
        "uncertainty, and left out: {}; measure it again.\n",
        each.hole,
        each.anywhere ? "in all set-ups"
                      : fmt::format("of {}", result.fused.fit.sources[each.setup].name),
        each.off.x() / kMicro, each.off.y() / kMicro, each.sigma,
        each.anywhere ? "a moved or damaged bush, or a wrong line of the certificate"
                      : "dirt, a wrong seat, or a wrong number");
  }
  return text;
}

std::vector<double> List(const VectorXd& values) { return {values.begin(), values.end()}; }

}  // namespace

ordered_json PlateJson(const PlateResult& result) {
  ordered_json json = FuseJson(result.fused);
  for (int error = 0; error < kMotionErrors; ++error) {
    const VectorXd stations = StationsOf(result, error);
    const auto curve = result.fused.map.CurveOf(error, stations);
    json["errors"][map::ErrorName(error)] = {
        {"stations", List(stations)}, {"value", List(curve.value)}, {"u", List(curve.u)}};
  }
  for (std::size_t k = 0; k < result.diagonals.size(); ++k) {
    const int error = kMotionErrors + static_cast<int>(k);
    const auto curve = result.fused.map.CurveOf(error, VectorXd::Zero(1));
    json["squareness"][map::ErrorName(error)] = {{"value", curve.value[0]}, {"u", curve.u[0]}};
    const auto& by = result.diagonals[k];
    if (by.setups == 0) continue;
    json["squareness"][map::ErrorName(error)]["diagonals"] = {
        {"value", by.value}, {"u", by.u}, {"setups", by.setups}};
  }
  for (const auto& each : result.interpolators) {
    ordered_json& one = json["interpolation"][each.name];
    one["heldout_rms_um"] = each.held_out / kMicro;
    if (each.learning.neurons == 0) continue;
    one["stations_rms_um"] = each.learning.rms / kMicro;
    one["neurons"] = each.learning.neurons;
    one["cycles"] = each.learning.cycles;
  }
  for (const auto& each : result.specimen) {
    json["specimen"].push_back({{"row", each.row + 1},
                                {"length_mm", each.length / kMillimetre},
                                {"before_mm", each.before / kMillimetre},
                                {"after_mm", each.after / kMillimetre},
                                {"u_um", each.u / kMicro}});
  }
  for (const auto& each : result.wrong_holes) {
    json["wrong_holes"].push_back({{"run", result.fused.fit.sources[each.setup].name},
                                   {"hole", each.hole},
                                   {"off_um", {each.off.x() / kMicro, each.off.y() / kMicro}},
                                   {"sigma", each.sigma},
                                   {"in_all_setups", each.anywhere}});
  }
  return json;
}

std::string PlateTable(const PlateResult& result) {
  return ErrorTable(result) + SquarenessTable(result) + WrongHolesText(result) +
         RunsText(result.fused) + InterpolatorTable(result) + SpecimenTable(result);
}

}  // namespace abbe::apps
