#include "apps/sensitivity_linkage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/command.h"
#include "apps/machine_file.h"
#include "apps/result_file.h"

namespace abbe::apps {
namespace {

relm::SensitivityVolume VolumeOf(const LinkageSensitivityOptions& options) {
  return {1e-3 * Eigen::Vector3d(options.size_mm.data()),
          1e-3 * Eigen::Vector3d(options.centre_mm.data()), options.points};
}

nlohmann::ordered_json ToJson(const relm::ParameterSensitivity& parameter) {
  return {
      {"name", parameter.name},         {"tolerance", parameter.tolerance},
      {"alone", parameter.alone},       {"worst", parameter.worst},
      {"first", parameter.share.first}, {"first_uncertainty", parameter.share.first_uncertainty},
      {"total", parameter.share.total}, {"total_uncertainty", parameter.share.total_uncertainty}};
}

// "12.34 +-0.56", in percent; no minus sign before a zero.
std::string Share(double value, double uncertainty) {
  const double percent = std::round(1e4 * value) / 100 + 0.0;
  return fmt::format("{:.2f} +-{:4.2f}", percent, 100 * uncertainty);
}

// Sorted, largest first.
void Print(const relm::LinkageSensitivity& result) {
  auto parameters = result.parameters;
  std::stable_sort(parameters.begin(), parameters.end(),
                   [](const auto& a, const auto& b) { return a.alone > b.alone; });
  fmt::print("\n{:<28}{:>10} {:<9}{:>9}{:>10}{:>15}{:>15}\n", "parameter", "tolerance", "",
             "alone um", "worst um", "first %", "total %");
  for (const auto& parameter : parameters) {
    const auto& share = parameter.share;
    fmt::print("{:<28}{:>10.4g} {:<9}{:>9.3g}{:>10.3g}{:>15}{:>15}\n", parameter.name,
               parameter.tolerance / parameter.unit.si, parameter.unit.name, 1e6 * parameter.alone,
               1e6 * parameter.worst, Share(share.first, share.first_uncertainty),
               Share(share.total, share.total_uncertainty));
  }
}

}  // namespace

int RunLinkageSensitivity(const LinkageSensitivityOptions& options) {
  const MachineFile file = ReadMachineFile(options.machine);
  const relm::LinkageSettings& linkage = file.Linkage();
  const relm::LinkageModel model =
      relm::MakeLinkageModel(linkage, options.model.value_or(relm::ErrorModel::kComplete));
  const relm::SensitivityVolume volume = VolumeOf(options);
  const auto poses = relm::PosesInVolume(linkage, volume, options.warmth_c);
  const auto result = relm::AnalyseSensitivity(model, poses, options.run);
  fmt::print(
      "Linkage of {}, model {}: {:.4g} um rms error (3D) of the tip's {}\nfrom all tolerances "
      "together; {} poses in {:g} x {:g} x {:g} mm, {} draws, seed {}\n",
      options.machine.string(), model.name(), 1e6 * result.together,
      options.run.displacement ? "displacement from the centre" : "position", poses.poses(),
      options.size_mm[0], options.size_mm[1], options.size_mm[2], options.run.draws,
      options.run.seed);
  Print(result);
  fmt::print(
      "\nalone: rms over the poses when only this parameter is off, by its tolerance; first "
      "and total: Sobol\nindices, shares of the mean squared tip error.\n");
  if (options.json.empty()) return kDone;
  nlohmann::ordered_json parameters = nlohmann::ordered_json::array();
  for (const auto& parameter : result.parameters) parameters.push_back(ToJson(parameter));
  WriteResult({{"machine", options.machine.string()},
               {"model", model.name()},
               {"size", {volume.size[0], volume.size[1], volume.size[2]}},
               {"centre", {volume.centre[0], volume.centre[1], volume.centre[2]}},
               {"poses", poses.poses()},
               {"warmth", options.warmth_c},
               {"displacement", options.run.displacement},
               {"draws", options.run.draws},
               {"seed", options.run.seed},
               {"together", result.together},
               {"parameters", parameters}},
              options.json);
  return kDone;
}

}  // namespace abbe::apps
