// The runs of one machine as the diagnosis takes them: each with its simulation and its trace.
//
//   Campaign campaign(setup);
//   for (const recording::Recording& recording : recordings) campaign.Add(recording);
//   const simulation::Scene scene = campaign.scene();
//
// Readings that are none (data_integrity.h) are found first and left out.
// Sweeps enter dwell by dwell, so that what changes from pass to pass stays visible. No row is
// weighted down by a robust loss: what looks like outliers may be the cause.
// A linkage whose axis positions are not recorded is an arm before an instrument
// (arm_in_campaign.h).
// Failure: InputError for a recording of another machine, of a kind that the diagnosis does not
// take or the machine file does not describe, and that of the simulations.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/data_integrity.h"
#include "fusion/machine_prior.h"
#include "machine/machine.h"
#include "probes/head_settings.h"
#include "recording/recording.h"
#include "relm/linkage_settings.h"
#include "simulation/causes/cause.h"
#include "simulation/linkage/linkage_run.h"
#include "simulation/shaft/shaft_noise.h"
#include "simulation/simulated_run.h"
#include "simulation/trace.h"

namespace abbe::diagnosis {

// What the diagnosis knows of an arm (simulation/arm/arm_run.h) from one of its runs: arm_baseline.h.
struct ArmBaseline {
  std::string mounting;            // of its base
  relm::LinkageSettings settings;  // its base where the instrument saw it
  Eigen::VectorXd x;               // of ArmSimulation(settings): what fits most poses
  relm::LinkageSettings lenient;   // with joints that may err more
  Eigen::VectorXd lenient_x;       // likewise
  double far = 0.0;                // whitened gap against `lenient` from which on a pose is none
  double excess = 1.0;             // of what the run leaves over its stated noise, at least 1
};

struct Setup {
  machine::Machine machine;
  std::optional<probes::HeadSettings> head;
  probes::TargetSettings target;
  probes::ProbeNoise noise;
  std::optional<relm::LinkageSettings> linkage;
  // m, of runs with a reference instrument that state none, by name; others are estimated.
  std::map<std::string, Eigen::Vector3d> reference_noise = {};
  // What whoever reads the result has to know of it.
  std::vector<std::string> notes = {};
  // Of runs of a shaft, by name.
  std::map<std::string, simulation::RimRepeats> shaft_repeats = {};
  std::map<std::string, ArmBaseline> arms = {};  // by run

  // A machine file may describe an arm and no axes.
  bool HasAxes() const;
};

inline constexpr Eigen::Index kMostPoses = 1500;  // of a linkage: time is for causes, not rows

struct DiagnosedRun {
  simulation::SimulatedRun simulated;
  simulation::Trace trace;
  std::optional<simulation::LinkageRun> arm = {};  // the run of an arm
  double excess = 1.0;  // of the noise that `simulated` is white with over what is stated
};

class Campaign {
 public:
  // `origin`: of the whole campaign, where this is a part of one.
  explicit Campaign(Setup setup, std::optional<simulation::Origin> origin = {});

  void Add(recording::Recording recording);

  simulation::Origin origin() const;

  bool HasArms() const;
  // Of arms, one for each run: up where it is half as much again, down by a twentieth at least;
  // false where nothing changes.
  enum class Change { kDown, kUp };
  bool SetExcess(const std::vector<double>& excess, Change change);

  const Setup& setup() const { return setup_; }
  const machine::VolumetricModel& model() const { return model_; }
  const fusion::MachinePrior& prior() const { return prior_; }
  // In the order of adding, on one clock.
  const std::vector<DiagnosedRun>& runs() const { return runs_; }
  simulation::Scene scene() const;
  // What whoever reads the result has to know of how the runs were taken.
  const std::vector<std::string>& notes() const { return notes_; }
  // What was found row by row and left out, on the clock of the campaign; each channel once.
  std::vector<BadData> bad_data() const;

 private:
  struct BadRows {
    double started;  // s since 1970
    BadData data;
  };

  Setup setup_;
  machine::VolumetricModel model_;
  fusion::MachinePrior prior_;
  std::optional<simulation::Origin> origin_;
  std::vector<DiagnosedRun> runs_;
  std::vector<BadRows> bad_;
  std::vector<std::string> notes_;
};

}  // namespace abbe::diagnosis
