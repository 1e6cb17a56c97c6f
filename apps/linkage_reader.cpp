#include "apps/linkage_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "fusion/calibration_file.h"
#include "relm/error_model_name.h"
#include "relm/tip_path.h"
#include "settings/unit.h"

namespace abbe::apps {

LinkageReader::LinkageReader(MachineFile file, const std::filesystem::path& calibration)
    : file_(std::move(file)), name_(calibration.filename().string()) {
  const relm::LinkageSettings& linkage = file_.Linkage();
  if (calibration.empty()) return;
  calibrated_.emplace(linkage, fusion::ReadCalibration(calibration, linkage));
  const std::string& of = calibrated_->calibration().machine;
  if (of.empty() || of == machine().name) return;
  throw InputError(fmt::format(
      "{}: was made on machine \"{}\", the machine file describes \"{}\"; give the calibration of "
      "the linkage on this machine",
      calibration.string(), of, machine().name));
}

paths::MeasuredPath LinkageReader::Path(const recording::Recording& recording) {
  relm::GoodReadings good = relm::ReadAngles(recording, file_.Linkage());
  runs_.push_back({recording.name, recording.HeaderText("mounting.base").value_or(""),
                   std::move(good.readings)});
  return paths::LinkagePath(recording, machine().chain, good.rows, Tips(runs_.back()));
}

Eigen::Matrix3Xd LinkageReader::Tips(const Run& run) const {
  if (calibrated_) return calibrated_->Tips(run.readings, run.mounting, /*strict=*/false);
  const relm::LinkageSettings& linkage = file_.Linkage();
  const auto model = relm::MakeLinkageModel(linkage, relm::ErrorModel::kComplete);
  Eigen::Matrix3Xd p_BT;
  model.Tips(run.readings, model.Values(), p_BT);
  return relm::InFrame(linkage.X_MB, p_BT);
}

std::vector<std::vector<Eigen::Matrix3Xd>> LinkageReader::IndependentErrors() const {
  if (!calibrated_ || runs_.empty()) return {};
  std::vector<const relm::LinkageReadings*> readings;
  std::vector<std::string> mountings;
  for (const Run& run : runs_) {
    readings.push_back(&run.readings);
    mountings.push_back(run.mounting);
  }
  auto errors = calibrated_->IndependentErrors(readings, mountings);
  for (auto& error : errors) {
    for (Eigen::Matrix3Xd& path : error) path = machine().chain.ToolSenses().asDiagonal() * path;
  }
  return errors;
}

nlohmann::ordered_json LinkageReader::Data() const {
  if (!calibrated_) return {{"parameters", "nominal"}};
  const fusion::Calibration& calibration = calibrated_->calibration();
  nlohmann::ordered_json data{{"parameters", "calibrated"},
                              {"file", name_},
                              {"model", relm::ErrorModelName(calibration.model)},
                              {"mapped", calibration.mapped.has_value()}};
  if (std::isfinite(calibration.held_out_rms)) {
    data["held_out_rms_um"] = calibration.held_out_rms / settings::kMicrometre;
  }
  return data;
}

std::vector<std::string> LinkageReader::Notes() const {
  if (!calibrated_) {
    return {
        "the linkage is read with its nominal parameters: positions are off by its tolerances; "
        "calibrate it with abbe calibrate and give --calibration FILE"};
  }
  const fusion::Calibration& calibration = calibrated_->calibration();
  std::string text =
      fmt::format("the linkage is read with the calibration {}, model \"{}\"{}", name_,
                  relm::ErrorModelName(calibration.model), calibration.mapped ? ", mapped" : "");
  if (std::isfinite(calibration.held_out_rms)) {
    text +=
        fmt::format("; held-out rms {:.2f} um", calibration.held_out_rms / settings::kMicrometre);
  }
  std::vector<std::string> notes{std::move(text)};
  for (const Run& run : runs_) {
    if (std::ranges::count(calibration.mountings, run.mounting) > 0) continue;
    notes.push_back(fmt::format(
        "{}: the calibration has no mounting \"{}\" of the base: displacements are valid, the "
        "set-up centre and positions are not",
        run.recording, run.mounting));
  }
  return notes;
}

}  // namespace abbe::apps
