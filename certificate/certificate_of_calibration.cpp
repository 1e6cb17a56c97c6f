#include "certificate/certificate_of_calibration.h"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "failure/failure.h"
#include "relm/error_model_name.h"

namespace abbe::certificate {
namespace {

// The unit in SI of a printed one.
std::string SiUnit(const std::string& printed) {
  if (printed == "um" || printed == "mm" || printed == "nm") return "m";
  if (printed == "urad" || printed == "deg") return "rad";
  if (printed == "ppm/degC") return "1/K";
  return printed == "ppm" ? "" : printed;
}

Series SeriesOf(const estimation::ParameterBlock& block) {
  Series series;
  series.name = block.name;
  series.unit = SiUnit(block.unit.name);
  for (const auto& entry : block.entries) {
    series.labels.push_back(entry.name);
    series.values.push_back(entry.value);
    if (!std::isfinite(entry.uncertainty)) {
      throw InputError(fmt::format(
          "{}.{} is not determined, and a certificate needs its uncertainty: give it a tolerance "
          "in [linkage.tolerance] and calibrate again",
          block.name, entry.name));
    }
    series.U95.push_back(standards::kCoverage * entry.uncertainty);
    if (entry.held) {
      series.words +=
          fmt::format("{}{} held at its value", series.words.empty() ? "" : ", ", entry.name);
    }
  }
  return series;
}

}  // namespace

Certificate CertificateOfCalibration(const fusion::Calibration& calibration) {
  Certificate certificate;
  certificate.title = fmt::format("Parameters of the linkage of {}", calibration.machine);
  certificate.methods = {
      fmt::format("fit of the encoder readings to reference positions (abbe), "
                  "error model {}",
                  relm::ErrorModelName(calibration.model))};
  if (std::isfinite(calibration.held_out_rms)) {
    certificate.remarks.push_back(fmt::format("Held-out poses are predicted to {:.3g} um rms (3D)",
                                              1e6 * calibration.held_out_rms));
  }
  if (calibration.mapped) {
    certificate.remarks.emplace_back(
        "The calibration is mapped; only its global parameters are certified");
  }
  std::map<std::string, std::pair<std::string, double>> of_name;
  for (const auto& block : calibration.blocks) {
    certificate.results.push_back(SeriesOf(block));
    for (std::size_t i = 0; i < block.entries.size(); ++i) {
      of_name[block.FullName(i)] = {SiUnit(block.unit.name), block.entries[i].value};
    }
  }
  Joint joint;
  joint.words = "free parameters of the linkage with the covariance of all of them";
  for (const std::string& name : calibration.names) {
    const auto found = of_name.find(name);
    if (found == of_name.end()) {
      throw InputError(
          fmt::format("the calibration has the covariance of {}, which is none of its "
                      "parameters: calibrate again",
                      name));
    }
    joint.names.push_back(name);
    joint.units.push_back(found->second.first);
    joint.values.push_back(found->second.second);
  }
  const auto all = calibration.covariance.reshaped();
  joint.covariance.assign(all.begin(), all.end());
  certificate.joint.push_back(std::move(joint));
  return certificate;
}

}  // namespace abbe::certificate
