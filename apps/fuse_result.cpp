#include "apps/fuse_result.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/map_json.h"
#include "apps/parameters_json.h"
#include "apps/rounded.h"
#include "fusion/plate_form.h"
#include "settings/unit.h"

namespace abbe::apps {
namespace {

using nlohmann::ordered_json;

using settings::kMicro;
constexpr double kFarOff = 9.0;  // chi-square over redundancy: three times the stated noise
constexpr double kOneAfterTheOther = 0.3;  // correlation from row to row; that of noise is less

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

// Chi-square over redundancy of a run under its stated noise; 0 where nothing is redundant.
double ExcessOf(const fusion::FuseReport& report, std::size_t run) {
  const auto& source = report.fit.sources[run];
  if (!(source.redundancy > 0.0)) return 0.0;
  return std::pow(report.noise[run], 2) * source.chi_square / source.redundancy;
}

// Runs with residuals far beyond their stated noise.
std::vector<std::string> Misfits(const fusion::FuseReport& report) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < report.runs.size(); ++i) {
    if (ExcessOf(report, i) > kFarOff) names.push_back(report.fit.sources[i].name);
  }
  return names;
}

// Lines of the machine file that the runs refute.
std::string MachineFileNotes(const fusion::FuseReport& report) {
  std::string text;
  for (const auto& line : report.statements) {
    if (!line.Refuted()) continue;
    text += fmt::format(
        "\n{}: {} = {:.3g}, but the runs say {:.3g}; the map follows the "
        "runs; state it\n",
        line.key == fusion::kPlateFormKey ? "RECORDING" : "MACHINE FILE", line.key,
        line.stated / line.unit, line.seen / line.unit);
  }
  for (std::size_t i = 0; i < report.noise.size(); ++i) {
    if (report.noise[i] == 1.0 || report.scatter[i].axis >= 0) continue;
    text += fmt::format(
        "\nMACHINE FILE: the noise of {} is {:.2g} times what is stated, and is taken so; state "
        "it\n",
        report.fit.sources[i].name, report.noise[i]);
  }
  return text;
}

std::string ScatterLines(const fusion::FuseReport& report) {
  std::string text;
  for (std::size_t i = 0; i < report.scatter.size(); ++i) {
    const int axis = report.scatter[i].axis;
    if (axis < 0) continue;
    const char name = "XYZ"[axis];
    const bool others = report.contradicting >= 0 || Misfits(report).size() > 1;
    text += fmt::format(
        "\nSCATTER: the places of {} scatter along {} alone, more than its noise: a wave of the "
        "screw, gear or scale of {}, shorter than the places are apart, rounded positions, lost "
        "motion that varies, a drift between the places, or a part that bends as finely{}. U95 of E{}{} contains it, {:.2g} um "
        "(rms) where no place is near; circles, or places closer together, show it.\n",
        report.fit.sources[i].name, name, name,
        others ? "; or it comes from the runs that do not fit or contradict (below)" : "", name,
        name, report.scatter[i].size() / kMicro);
  }
  return text;
}

std::string DriftLines(const fusion::FuseReport& report) {
  std::string text;
  for (std::size_t i = 0; i < report.memory.size(); ++i) {
    const auto& memory = report.memory[i];
    if (!memory) continue;
    text += fmt::format(
        "\nDRIFT: what {} reads goes on from row to row, {:.2g} times its stated noise (rms) and fading within "
        "{:.2g} s: an instrument or machine that drifts or warms up, a wave along the path, or, if nothing drifts so "
        "far, a chain, [head] or [linkage] that are not those of the recording. U95 contains it as a drift; places in "
        "another order, or one place again and again between them, tell it from the errors of the axes.\n",
        report.fit.sources[i].name, memory->slow, memory->time);
  }
  return text;
}

std::string NoteLines(const fusion::FuseReport& report) {
  std::string text;
  for (const std::string& note : report.notes) text += "\nRECORDING: " + note + '\n';
  return text;
}

std::string ReversalLines(const fusion::FuseReport& report) {
  std::string text;
  for (const auto& each : report.reversals) {
    text += fmt::format(
        "\nREVERSAL: {} forward minus backward {} {} (95 %); the map is the mean of both directions{}\n",
        each.name, PlusMinus(each.value / settings::kMicro, 2.0 * each.u / settings::kMicro),
        each.rotates ? "urad" : "um",
        report.contradicting < 0 ? "" : ", unless it comes from the run that contradicts (below)");
  }
  return text;
}

// What of its own would make a run agree, and what to do.
const char* WordsOf(fusion::Suspect suspect) {
  switch (suspect) {
    case fusion::Suspect::kMounting:
      return "it agrees if it was mounted anew: state another mounting in its header, or leave it "
             "out and fuse again.";
    case fusion::Suspect::kInstrument:
      return "it agrees if its instrument was another: check that it was made with the same head, "
             "target, linkage and ball, or leave it out and fuse again.";
    case fusion::Suspect::kNone:
      break;
  }
  return "neither rougher nor larger errors, larger noise, a less flat target, another mounting "
         "nor another instrument explains it; look at its set-up, or leave it out and fuse again.";
}

std::vector<std::string> MayBeWrong(const fusion::FuseReport& report) {
  std::vector<std::string> names;
  for (const int run : report.may_be_wrong) names.push_back(report.runs[run].name);
  return names;
}

std::string WhichIsWrong(const fusion::FuseReport& report) {
  const std::string& named = report.runs[report.contradicting].name;
  std::vector<std::string> others = MayBeWrong(report);
  std::erase(others, named);
  if (report.may_be_wrong.empty()) {
    return ", and leaving out no single run makes the rest agree: the machine changed between the "
           "runs, or has an error that no map holds, such as one of two positions or of the way it "
           "came. abbe diagnose of all recordings looks for it.";
  }
  if (others.empty()) return fmt::format("; {}", WordsOf(report.suspect));
  const char* own = report.suspect == fusion::Suspect::kMounting ? " (which agrees if mounted anew)"
                    : report.suspect == fusion::Suspect::kInstrument
                        ? " (which agrees with another instrument)"
                        : "";
  return fmt::format(
      "; but without {} the rest agrees too, so the data do not tell which is wrong, or whether the "
      "machine changed between them: look at {}{} and at each of these.",
      fmt::join(others, ", or without "), named, own);
}

std::string RunTable(const fusion::FuseReport& report) {
  std::string text = fmt::format("\n{:<32}{:<11}{:>7}{:>13}{:>22}\n", "run", "kind", "rows",
                                 "chi2/redund.", "p of its agreement");
  for (std::size_t i = 0; i < report.runs.size(); ++i) {
    const auto& source = report.fit.sources[i];
    text += fmt::format("{:<32}{:<11}{:>7}{:>13.3f}{:>22}\n", source.name, report.kinds[i],
                        source.rows, ExcessOf(report, i),
                        report.runs[i].directions == 0
                            ? "no other run sees it"
                            : fmt::format("{:.2g}", report.runs[i].probability));
  }
  return text;
}

const char* WhatFits(const fusion::FuseReport& report, std::size_t run) {
  if (report.scatter[run].axis >= 0) return "its places scatter along one axis (above)";
  if (!(report.follows[run] < kOneAfterTheOther)) {
    return "what is left goes on from row to row, so neither larger noise nor rougher errors nor a "
           "less flat target fits; check that chain, [head] and [linkage] of the machine file are "
           "those of the recording";
  }
  const bool axis = std::any_of(report.scatter.begin(), report.scatter.end(),
                                [](const auto& each) { return each.axis >= 0; });
  return axis ? "what is left scatters from row to row, as places do along an axis (above): it is "
                "that axis, or larger noise"
              : "what is left scatters from row to row, so larger noise fits: state it";
}

std::string MisfitLines(const fusion::FuseReport& report) {
  std::string text;
  for (std::size_t i = 0; i < report.runs.size(); ++i) {
    if (!(ExcessOf(report, i) > kFarOff)) continue;
    text += fmt::format("\nDOES NOT FIT: {} is off by {:.1f} times its noise; {}.\n",
                        report.runs[i].name, std::sqrt(ExcessOf(report, i)), WhatFits(report, i));
  }
  return text;
}

std::string ContradictionLine(const fusion::FuseReport& report) {
  if (report.contradicting < 0) return "";
  const auto& run = report.runs[report.contradicting];
  return fmt::format(
      "\nCONTRADICTION: {} disagrees with all other runs (chi-square {:.1f} of {}){} Until then "
      "every U95 of the map is stated {:.1f} times as large.\n",
      run.name, run.statistic, run.directions, WhichIsWrong(report), report.widened);
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

std::string RunsText(const fusion::FuseReport& report) {
  return ScaleText(report.scale) +
         fmt::format("Correlation length of the error functions: {:.1f} mm\n",
                     1e3 * report.chosen_smoothness) +
         NoteLines(report) + ReversalLines(report) + DriftLines(report) + ScatterLines(report) +
         MachineFileNotes(report) + RunTable(report) + MisfitLines(report) +
         ContradictionLine(report);
}

ordered_json FuseJson(const fusion::FuseReport& report) {
  ordered_json json{{"abbe", ABBE_VERSION},
                    {"command", "fuse"},
                    {"machine", report.map.origin().machine},
                    {"chain", report.map.model().chain().Text()}};
  json["scale"] = {{"value_ppm", report.scale.value / kMicro},
                   {"u_ppm", report.scale.u / kMicro},
                   {"prior_ppm", report.scale.prior / kMicro},
                   {"statement", report.map.Scale()}};
  json["smoothness_mm"] = 1e3 * report.chosen_smoothness;
  json["machine_file"] = ordered_json::object();
  for (const auto& line : report.statements) {
    json["machine_file"][std::string(line.key)] = {{"stated", line.stated / line.unit},
                                                   {"seen", line.seen / line.unit},
                                                   {"u_log", line.u_log},
                                                   {"refuted", line.Refuted()}};
  }
  json["notes"] = report.notes;
  json["reversals"] = ordered_json::array();
  for (const auto& each : report.reversals) {
    json["reversals"].push_back({{"error", each.name},
                                 {"value", each.value / settings::kMicro},
                                 {"u", each.u / settings::kMicro},
                                 {"unit", each.rotates ? "urad" : "um"}});
  }
  json["scatter"] = ordered_json::array();
  for (std::size_t i = 0; i < report.scatter.size(); ++i) {
    const int axis = report.scatter[i].axis;
    if (axis < 0) continue;
    json["scatter"].push_back({{"run", report.fit.sources[i].name},
                               {"axis", std::string(1, "XYZ"[axis])},
                               {"sd_um", report.scatter[i].size() / kMicro}});
  }
  json["drifts"] = ordered_json::array();
  for (std::size_t i = 0; i < report.memory.size(); ++i) {
    const auto& memory = report.memory[i];
    if (!memory) continue;
    json["drifts"].push_back({{"run", report.fit.sources[i].name},
                              {"over_noise", memory->slow},
                              {"time_s", memory->time}});
  }
  for (const auto& function : report.functions) {
    json["observability"][function.name] = {
        {"prior", function.prior}, {"u", function.u}, {"determined_by", function.determined_by}};
  }
  for (std::size_t i = 0; i < report.runs.size(); ++i) {
    const auto& source = report.fit.sources[i];
    json["chi2"].push_back({{"run", source.name},
                            {"kind", report.kinds[i]},
                            {"rows", source.rows},
                            {"chi2", source.chi_square},
                            {"redundancy", source.redundancy},
                            {"outliers", source.outlier_count},
                            {"noise", report.noise[i]},
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
    json["contradictions"].push_back(report.runs[report.contradicting].name);
    json["may_be_wrong"] = MayBeWrong(report);
    json["widened"] = report.widened;
  }
  json["parameters"] = ParametersJson(report.fit);
  json["map"] = MapJson(report.map);
  return json;
}

std::string FuseTable(const fusion::FuseReport& report) {
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
  return text + RunsText(report) + HoldoutTable(report);
}

}  // namespace abbe::apps
