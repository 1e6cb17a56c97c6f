#include "apps/fuse_result.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/map_json.h"
#include "apps/parameters_json.h"
#include "settings/unit.h"

namespace abbe::apps {
namespace {

using nlohmann::ordered_json;

using settings::kMicro;
constexpr double kFarOff = 9.0;  // chi-square over redundancy: three times the stated noise

std::string ScaleText(const fusion::ScaleSeen& scale) {
  return fmt::format(
      "\nIsotropic scale {:+.2f} ppm, u {:.2f} ppm, {:.2f} ppm before the data: {}\n",
      scale.value / kMicro, scale.u / kMicro, scale.prior / kMicro,
      scale.calibrated ? "calibrated" : "PRIOR ONLY; give a run of kind length");
}

// The error functions that no run determines.
std::vector<std::string> PriorOnly(const fusion::FuseReport& report) {
  std::vector<std::string> names;
  for (const auto& function : report.functions) {
    if (function.determined_by.empty()) names.push_back(function.name);
  }
  return names;
}

// Runs with residuals far beyond their stated noise.
std::vector<std::string> Misfits(const fusion::FuseReport& report) {
  std::vector<std::string> names;
  for (const auto& source : report.fit.sources) {
    if (source.is_prior || !(source.redundancy > 0.0)) continue;
    if (source.chi_square > kFarOff * source.redundancy) names.push_back(source.name);
  }
  return names;
}

std::string RunTable(const fusion::FuseReport& report,
                     const std::vector<simulation::SimulatedRun>& runs) {
  std::string text = fmt::format("\n{:<32}{:<11}{:>7}{:>13}{:>22}\n", "run", "kind", "rows",
                                 "chi2/redund.", "p of its agreement");
  for (std::size_t i = 0; i < report.runs.size(); ++i) {
    const auto& source = report.fit.sources[i];
    text += fmt::format(
        "{:<32}{:<11}{:>7}{:>13.3f}{:>22}\n", source.name, runs[i].kind, source.rows,
        source.redundancy > 0.0 ? source.chi_square / source.redundancy : 0.0,
        report.runs[i].directions == 0 ? "no other run sees it"
                                       : fmt::format("{:.2g}", report.runs[i].probability));
  }
  for (const std::string& name : Misfits(report)) {
    text += fmt::format(
        "\nDOES NOT FIT: {} is off by many times its noise; check that chain, [head] and [linkage] "
        "of the machine file are those of the recording, and its noise.\n",
        name);
  }
  if (report.contradicting >= 0) {
    const auto& run = report.runs[static_cast<std::size_t>(report.contradicting)];
    text += fmt::format(
        "\nCONTRADICTION: {} disagrees with all other runs (chi-square {:.1f} of {}); look at its "
        "set-up, or leave it out and fuse again.\n",
        run.name, run.statistic, run.directions);
  }
  return text;
}

std::string HoldoutTable(const fusion::FuseReport& report) {
  if (report.held_out.empty()) return "";
  std::string text = fmt::format("\n{:<32}{:>10}{:>13}{:>22}\n", "held out, predicted", "rows",
                                 "chi2/expected", "rms / own noise");
  for (const auto& run : report.held_out) {
    text += fmt::format("{:<32}{:>10}{:>13.3f}{:>22.3f}\n", run.name, run.rows,
                        run.chi_square / run.expected, run.rms);
  }
  return text;
}

}  // namespace

std::string DeterminedBy(const fusion::FunctionSeen& function) {
  return function.determined_by.empty()
             ? "prior only"
             : fmt::format("{}", fmt::join(function.determined_by, ", "));
}

std::string RunsText(const fusion::FuseReport& report,
                     const std::vector<simulation::SimulatedRun>& runs) {
  return ScaleText(report.scale) +
         fmt::format("Correlation length of the error functions: {:.1f} mm\n",
                     1e3 * report.chosen_smoothness) +
         RunTable(report, runs);
}

ordered_json FuseJson(const fusion::FuseReport& report,
                      const std::vector<simulation::SimulatedRun>& runs) {
  ordered_json json{{"abbe", ABBE_VERSION},
                    {"command", "fuse"},
                    {"machine", report.map.origin().machine},
                    {"chain", report.map.model().chain().Text()}};
  json["scale"] = {{"value_ppm", report.scale.value / kMicro},
                   {"u_ppm", report.scale.u / kMicro},
                   {"prior_ppm", report.scale.prior / kMicro},
                   {"statement", report.map.Scale()}};
  json["smoothness_mm"] = 1e3 * report.chosen_smoothness;
  for (const auto& each : report.smoothness) {
    json["smoothness_tried"].push_back(
        {{"length_mm", 1e3 * each.length}, {"log_evidence", each.log_evidence}});
  }
  for (const auto& function : report.functions) {
    json["observability"][function.name] = {
        {"prior", function.prior}, {"u", function.u}, {"determined_by", function.determined_by}};
  }
  for (std::size_t i = 0; i < report.runs.size(); ++i) {
    const auto& source = report.fit.sources[i];
    json["chi2"].push_back({{"run", source.name},
                            {"kind", runs[i].kind},
                            {"rows", source.rows},
                            {"chi2", source.chi_square},
                            {"redundancy", source.redundancy},
                            {"outliers", source.outlier_count},
                            {"agreement",
                             {{"statistic", report.runs[i].statistic},
                              {"directions", report.runs[i].directions},
                              {"p", report.runs[i].probability}}}});
  }
  for (const auto& run : report.held_out) {
    json["held_out"].push_back({{"run", run.name},
                                {"rows", run.rows},
                                {"chi2", run.chi_square},
                                {"expected", run.expected},
                                {"rms", run.rms}});
  }
  json["prior_only"] = PriorOnly(report);
  json["misfits"] = Misfits(report);
  json["contradictions"] = ordered_json::array();
  if (report.contradicting >= 0) {
    json["contradictions"].push_back(
        report.runs[static_cast<std::size_t>(report.contradicting)].name);
  }
  json["parameters"] = ParametersJson(report.fit);
  json["map"] = MapJson(report.map);
  return json;
}

std::string FuseTable(const fusion::FuseReport& report,
                      const std::vector<simulation::SimulatedRun>& runs) {
  std::string text =
      fmt::format("{:<7}{:>10}{:>10}  {:<6}{}\n", "error", "before", "u", "unit", "determined by");
  for (const auto& function : report.functions) {
    const bool length = function.name[1] >= 'X';
    text +=
        fmt::format("{:<7}{:>10.3f}{:>10.3f}  {:<6}{}\n", function.name, function.prior / kMicro,
                    function.u / kMicro, length ? "um" : "urad", DeterminedBy(function));
  }
  if (const auto names = PriorOnly(report); !names.empty()) {
    text += fmt::format(
        "\nPRIOR ONLY: no run determines {}; the map has the prior of the machine file for them.\n",
        fmt::join(names, ", "));
  }
  return text + RunsText(report, runs) + HoldoutTable(report);
}

}  // namespace abbe::apps
