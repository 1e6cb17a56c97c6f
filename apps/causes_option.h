// The option --causes: an extended model (abbe diagnose -o) whose causes are corrected in the
// recordings before a command evaluates them.
//
//   CauseCorrection causes(path, file, kForMaps);
//   const recording::Recording corrected = causes.Take(recording);
//   fmt::print("{}", causes.Line());
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/machine_file.h"
#include "simulation/correction.h"

namespace abbe::apps {

// Adds the option --causes to a command.
CLI::Option* AddCausesOption(CLI::App& command, std::filesystem::path& path);

// Which causes a command corrects (simulation/causes/cause.h).
using Corrections = std::vector<simulation::CorrectedBy>;
// For measuring the machine: its own errors stay.
inline const Corrections kForMeasuring{simulation::CorrectedBy::kInstrument};
// For a map, which contains the errors that are functions of position.
inline const Corrections kForMaps{simulation::CorrectedBy::kInstrument,
                                  simulation::CorrectedBy::kMotion};
// For calibrating, where the machine is the reference.
inline const Corrections kForCalibrating{simulation::CorrectedBy::kInstrument,
                                         simulation::CorrectedBy::kMotion,
                                         simulation::CorrectedBy::kMap};

class CauseCorrection {
 public:
  // An empty path corrects nothing.
  CauseCorrection(const std::filesystem::path& path, const MachineFile& file,
                  const Corrections& taken);

  bool Active() const { return !name_.empty(); }
  // Returns the corrected recording and adds its changes to Line() and Data().
  recording::Recording Take(recording::Recording recording);

  const std::vector<simulation::ModelledCause>& taken() const { return taken_; }
  const std::vector<simulation::ModelledCause>& left() const { return left_; }
  // "causes of mill.toml taken out: backlash:X; positions by 3 um rms, 3.1 um at most"; empty
  // without a model.
  std::string Line() const;
  nlohmann::ordered_json Data() const;

 private:
  std::string name_;
  simulation::Instruments instruments_;
  simulation::Origin origin_;
  std::vector<simulation::ModelledCause> taken_, left_;
  simulation::Changes changes_;
};

// For the commands that use a map: the displacement along a path by causes that are not in the map.
class PathCauses {
 public:
  // An empty path: no displacement.
  PathCauses(const std::filesystem::path& path, const std::string& machine, double feed_mm_min);

  bool Active() const { return !name_.empty(); }
  // The displacement of the axes at the points of a path, m; 3 x points.
  Eigen::Matrix3Xd Beside(const Eigen::Matrix3Xd& path) const;
  std::vector<std::string> Names() const;
  std::string Line() const;

 private:
  std::string name_;
  double feed_ = 0.0;                                     // m/s
  std::vector<simulation::ModelledCause> causes_, left_;  // left_: depend on time or a temperature
};

// Adds the options --causes and --feed-mm-min to a command.
void AddPathCauses(CLI::App& command, std::filesystem::path& path, double& feed_mm_min);

}  // namespace abbe::apps
