// Paths of the ball from recordings of the linkage, with the parameters of a calibration or the
// nominal ones of the machine file.
//
//   LinkageReader reader(ReadMachineFile(machine), calibration);
//   const paths::MeasuredPath path = reader.Path(recording);
//   reader.IndependentErrors();    // [error][path]: 3 x poses, m, for one standard deviation
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
  // `calibration` empty: nominal parameters.
  LinkageReader(MachineFile file, const std::filesystem::path& calibration);

  const machine::Machine& machine() const { return file_.sweep_setup.machine; }

  paths::MeasuredPath Path(const recording::Recording& recording);
  // The displacement of all paths so far by each independent error of the calibration, as large as
  // its standard deviation, largest first. Empty without a calibration.
  std::vector<std::vector<Eigen::Matrix3Xd>> IndependentErrors() const;

  // The parameters used, for the result and as notes.
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
