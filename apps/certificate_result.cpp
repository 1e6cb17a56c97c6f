#include "apps/certificate_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "apps/machine_file.h"
#include "apps/result_file.h"
#include "certificate/certificate_of_calibration.h"
#include "certificate/doubts_of_result.h"
#include "fusion/calibration_file.h"
#include "history/conformity.h"
#include "history/figures_of_result.h"
#include "map/map_file.h"
#include "recording/file_hash.h"
#include "settings/unit.h"

namespace abbe::apps {
namespace {

using certificate::Certificate;
using nlohmann::ordered_json;

constexpr double kOfCurves = 2e-12;  // m or rad: curves in a result are rounded to 1e-12

[[noreturn]] void RefuseStrangeResult(const CertificateSources& sources, const std::string& what) {
  throw InputError(
      fmt::format("{}: is not the result of {}: {}; give the --json of the command "
                  "that wrote it",
                  sources.result.string(), sources.of.string(), what));
}

// The JSON's curves are those of the map.
void RequireSameMap(const ordered_json& result, const map::ErrorMap& map,
                    const CertificateSources& sources) {
  const ordered_json errors =
      result.value("map", ordered_json::object()).value("errors", ordered_json::object());
  for (int error = 0; error < map::kErrors; ++error) {
    const std::string name = map::ErrorName(error);
    const ordered_json one = errors.value(name, ordered_json::object());
    if (!one.contains("value")) RefuseStrangeResult(sources, "it has no " + name);
    const bool is_curve = one["value"].is_array();
    const auto numbers = [&](const char* key) {
      return is_curve ? one.value(key, std::vector<double>())
                      : std::vector<double>{one.value(key, 0.0)};
    };
    const auto positions = is_curve ? numbers("positions") : std::vector<double>{0.0};
    const auto values = numbers("value");
    if (positions.size() != values.size()) RefuseStrangeResult(sources, name + " is ragged");
    if (is_curve && !(map.model().travels()[error / machine::kMotions].last >
                      map.model().travels()[error / machine::kMotions].first)) {
      continue;  // no such axis
    }
    const auto curve = map.CurveOf(
        error, Eigen::Map<const Eigen::VectorXd>(positions.data(), std::ssize(positions)));
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (std::abs(curve.value[i] - values[i]) <= kOfCurves) continue;
      RefuseStrangeResult(
          sources, fmt::format("{} differs by {:.3g}", name, std::abs(curve.value[i] - values[i])));
    }
  }
}

// The JSON's parameters are those of the calibration.
void RequireSameCalibration(const ordered_json& result, const fusion::Calibration& calibration,
                            const CertificateSources& sources) {
  std::map<std::string, double> values;
  for (const ordered_json& each : result.value("parameters", ordered_json::array())) {
    if (each.is_object() && each.contains("value") && each["value"].is_number()) {
      values[each.value("name", "")] = each["value"].get<double>();
    }
  }
  constexpr double kUnit = 1e-9;  // of a printed number, by its rounding
  for (const auto& block : calibration.blocks) {
    for (std::size_t i = 0; i < block.entries.size(); ++i) {
      const auto found = values.find(block.FullName(i));
      const double printed = block.entries[i].value / block.unit.si;
      if (found == values.end() || std::abs(found->second - printed) > kUnit) {
        RefuseStrangeResult(sources, block.FullName(i) + " differs");
      }
    }
  }
}

// A plate's holes as its runs see them: the names are "plate_hole PLATE N.u" and ".v".
void AddHoles(const ordered_json& result, Certificate& made) {
  constexpr std::string_view kHole = "plate_hole ";
  std::map<std::string, certificate::Series> found;
  for (const ordered_json& each : result.value("parameters", ordered_json::array())) {
    const std::string name = each.is_object() ? each.value("name", "") : "";
    const auto dot = name.rfind('.'), blank = name.rfind(' ', dot);
    if (!name.starts_with(kHole) || dot == std::string::npos || blank < kHole.size()) continue;
    if (!each.value("uncertainty", ordered_json()).is_number()) continue;
    const std::string plate = name.substr(kHole.size(), blank - kHole.size());
    const std::string along = name.substr(dot + 1);
    certificate::Series& series = found[plate + " " + along];
    series.name = fmt::format("holes of plate {} along {}", plate, along);
    series.words =
        "place of each hole less that of its certificate; the covariance between holes is not kept";
    series.unit = "m";
    series.labels.push_back(name.substr(blank + 1, dot - blank - 1));
    const double si = settings::UnitOf("hole_" + each.value("unit", "")).si;
    series.values.push_back(each.value("value", 0.0) * si);
    series.U95.push_back(standards::kCoverage * each.value("uncertainty", 0.0) * si);
  }
  for (auto& [name, series] : found) made.results.push_back(std::move(series));
}

std::string StatusOf(const history::Judged& judged) {
  if (judged.verdict == history::Verdict::kPass) return "pass";
  if (judged.verdict == history::Verdict::kFail) return "fail";
  return std::abs(judged.value) <= judged.limit.size ? "conditionalPass" : "conditionalFail";
}

// What ISO 14253-1 says of the limits of the machine file; nothing beside a doubt. A quantity may be
// nothing but its unit: "urad" of a squareness.
void AddConformities(const ordered_json& result, const history::Limits& limits, Certificate& made) {
  if (limits.empty() || made.administration.decision_rule != certificate::kIso14253) return;
  if (!made.doubts.empty()) {
    made.remarks.emplace_back(
        "The machine has limits; no conformity with them is stated, because of the reservations");
    return;
  }
  for (const auto& judged : history::Judge(history::FiguresOf(result).figures, limits)) {
    if (judged.verdict == history::Verdict::kNotMeasured) {
      made.remarks.push_back(fmt::format("Limit {}: not measured", judged.limit.Name()));
      continue;
    }
    const std::string name =
        judged.object.empty() ? judged.limit.quantity : judged.object + "." + judged.limit.quantity;
    if (!judged.U95) {
      made.remarks.push_back(
          fmt::format("Limit {}: the result states no uncertainty, so no conformity", name));
      continue;
    }
    made.conformities.push_back(
        {judged.conditions.empty() ? name : fmt::format("{}, {}", name, judged.conditions),
         std::string(settings::UnitOf("_" + judged.limit.quantity).name), StatusOf(judged),
         judged.value, *judged.U95, judged.limit.size});
  }
}

bool IsCalibration(const std::filesystem::path& path) {
  return settings::Document::Read(path).Root().Has("model");
}

// The results of the map or calibration, checked against the JSON.
Certificate ResultsOf(const CertificateSources& sources, const ordered_json& result,
                      certificate::Sense sense, int points, std::string& machine) {
  if (IsCalibration(sources.of)) {
    if (sense == certificate::Sense::kTool) {
      throw InputError(
          fmt::format("{}: is a calibration of a linkage, for which QIF has no place; "
                      "take --format dcc",
                      sources.of.string()));
    }
    const auto calibration =
        fusion::ReadCalibration(sources.of, ReadMachineFile(sources.machine).Linkage());
    machine = calibration.machine;
    RequireSameCalibration(result, calibration, sources);
    return certificate::CertificateOfCalibration(calibration);
  }
  const map::ErrorMap map = map::ReadMap(sources.of);
  machine = map.origin().machine;
  RequireSameMap(result, map, sources);
  Certificate made = certificate::CertificateOfMap(map, points, sense);
  AddHoles(result, made);
  return made;
}

void AddDoubts(const ordered_json& result, std::vector<std::string>& doubts) {
  for (std::string& each : certificate::DoubtsOfResult(result)) doubts.push_back(std::move(each));
}

}  // namespace

Certificate MakeCertificate(const CertificateSources& sources, certificate::Sense sense,
                            int points) {
  const machine::Machine machine = ReadMachineOf(sources.machine);
  const auto data_document =
      settings::Document::Read(sources.data.empty() ? sources.machine : sources.data);
  const auto administration = certificate::ReadAdministration(data_document.Root());
  if (!sources.data.empty()) data_document.Root().RefuseUnknown();
  const ordered_json result = ReadResult(sources.result);
  std::string name;
  Certificate made = ResultsOf(sources, result, sense, points, name);
  if (name != machine.name) {
    throw InputError(fmt::format("{}: is of the machine \"{}\", {} describes \"{}\"",
                                 sources.of.string(), name, sources.machine.string(),
                                 machine.name));
  }
  made.administration = administration;
  made.release = ABBE_VERSION;
  AddDoubts(result, made.doubts);
  if (result.value("simulated", false)) {
    made.remarks.emplace_back("Simulated recordings: no machine was measured");
  }
  std::vector<std::filesystem::path> files{sources.of, sources.result};
  if (!sources.diagnosis.empty()) {
    const ordered_json diagnosis = ReadResult(sources.diagnosis);
    if (diagnosis.value("command", "") != "diagnose" || diagnosis.value("machine", "") != name) {
      throw InputError(fmt::format("{}: is no diagnosis of {}; give the --json of abbe diagnose",
                                   sources.diagnosis.string(), name));
    }
    AddDoubts(diagnosis, made.doubts);
    files.push_back(sources.diagnosis);
  }
  for (const auto& file : files) {
    made.remarks.push_back(fmt::format("Made of {}, SHA-256 {}", file.filename().string(),
                                       recording::Sha256OfFile(file)));
  }
  const auto machine_document = settings::Document::Read(sources.machine);
  AddConformities(result, history::ReadLimits(machine_document.Root()), made);
  return made;
}

}  // namespace abbe::apps
