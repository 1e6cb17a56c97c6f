// The option --causes: an extended model (abbe diagnose -o) whose causes are corrected in the
// recordings before a command evaluates them.
//
//   CauseCorrection causes(option, file, kForMaps);
//   const recording::Recording corrected = causes.Take(recording);
//   const recording::Recording other = causes.TakeCertain(recording);  // simulation/doubt.h
//   fmt::print("{}", causes.Line());
//
// Failure: InputError for a model beside which something is unexplained, without
// --although-unexplained, and that of simulation/extended_model.h.
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

struct CausesOption {
  std::filesystem::path path;  // empty: none
  bool although_unexplained = false;
};

// Adds the options --causes and --although-unexplained to a command.
void AddCausesOption(CLI::App& command, CausesOption& option);

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
  // Without a path nothing is corrected.
  CauseCorrection(const CausesOption& option, const MachineFile& file, const Corrections& taken);
  CauseCorrection(const CausesOption& option, simulation::Instruments instruments,
                  const Corrections& taken);

  bool Active() const { return !name_.empty(); }
  // Returns the corrected recording and adds its changes to Line() and Data().
  recording::Recording Take(recording::Recording recording);
  // The same by those causes alone that are certain.
  recording::Recording TakeCertain(const recording::Recording& recording) const;

  // Whether a U95 has to contain the change by causes that are not certain, or what is unexplained.
  bool WidensU95() const { return unexplained_ > 0.0 || certain_.size() < taken_.size(); }
  bool TakesCertain() const { return !certain_.empty(); }
  // m rms, of all leftovers.
  double unexplained() const { return unexplained_; }

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
  std::vector<simulation::ModelledCause> taken_, certain_, left_;
  double unexplained_ = 0.0;
  std::string verdict_, doubts_;
  simulation::Changes changes_;
};

// For the commands that use a map: the displacement along a path by causes that are not in the map.
class PathCauses {
 public:
  // Without a path there is no displacement.
  PathCauses(const CausesOption& option, const std::string& machine, double feed_mm_min);

  bool Active() const { return !name_.empty(); }
  // The displacement of the axes at the points of a path, m; 3 x points.
  Eigen::Matrix3Xd Beside(const Eigen::Matrix3Xd& path) const;
  std::string Line() const;
  // Adds `causes`, and `causes_doubt` where there is any.
  void AddTo(nlohmann::ordered_json& result) const;

 private:
  std::string name_, doubts_;
  double feed_ = 0.0;                                     // m/s
  std::vector<simulation::ModelledCause> causes_, left_;  // left_: depend on time or a temperature
};

// Adds the options --causes, --although-unexplained and --feed-mm-min to a command.
void AddPathCauses(CLI::App& command, CausesOption& option, double& feed_mm_min);

}  // namespace abbe::apps
