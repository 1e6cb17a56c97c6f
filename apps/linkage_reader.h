// From recordings of the linkage to paths of its ball, by a calibration or by the nominal
// parameters of the machine file.
//
//   LinkageReader reader(ReadMachineFile(machine), calibration);
//   const paths::MeasuredPath path = reader.Path(recording);
//   reader.IndependentErrors();    // [error][path]: 3 x poses, m, as large as its uncertainty
//
// Frames: axis coordinates, as in paths/measured_path.h. Failure: InputError for a machine file
// without a linkage, or a calibration of another machine or linkage.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/machine_file.h"
#include "fusion/calibration.h"
#include "paths/measured_path.h"

namespace abbe::apps {

class LinkageReader {
 public:
  // No calibration: empty.
  LinkageReader(MachineFile file, const std::filesystem::path& calibration);

  const machine::Machine& machine() const { return file_.sweep_setup.machine; }

  paths::MeasuredPath Path(const recording::Recording& recording);
  // Of all paths so far: what the uncertainty of the calibration does to them, one independent
  // error after the other, largest first. Empty without a calibration.
  std::vector<std::vector<Eigen::Matrix3Xd>> IndependentErrors() const;

  // How the linkage was read, for the result and in words.
  nlohmann::ordered_json Data() const;
  std::vector<std::string> Notes() const;

 private:
  struct Run {
    std::string recording, mounting;
    relm::LinkageReadings readings;
  };

  Eigen::Matrix3Xd Tips(const Run& run) const;

  MachineFile file_;
  std::string name_;  // of the calibration file
  std::optional<fusion::CalibratedLinkage> calibrated_;
  std::vector<Run> runs_;
};

}  // namespace abbe::apps
