// The runs of one machine as the diagnosis takes them: each with its simulation and its trace.
//
//   Campaign campaign(instruments);
//   for (const recording::Recording& recording : recordings) campaign.Add(recording);
//   const simulation::Scene scene = campaign.scene();
//
// Invalid readings (invalid_readings.h) are found first and left out. Rows enter in full detail
// (simulation/run_kind.h), so that what changes from pass to pass stays visible, and no row is
// weighted down by a robust loss: what looks like outliers may be the cause.
// Units: SI. Shapes: runs in the order of adding.
// Failure: InputError for a recording of another machine, of a kind that abbe does not know or the
// machine file does not describe, and that of the simulations.
// Source: docs/theory-diagnosis.md.
// Validity: runs of one machine in one state: what changes between them has to be a cause.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "estimation/noise_memory.h"
#include "fusion/machine_prior.h"
#include "recording/recording.h"
#include "simulation/causes/cause.h"
#include "simulation/instruments.h"
#include "simulation/learned/learned_term.h"
#include "simulation/run_kind.h"

namespace abbe::diagnosis {

using simulation::InvalidReadings;
using simulation::PreparedRun;

// Readings of a channel that a fit takes for outliers (stray_readings.h).
struct StrayReadings {
  std::string run;            // name of the recording
  std::string object;         // "probe_a", "pivot_1"
  std::vector<double> times;  // s since the recording began
};

class Campaign {
 public:
  explicit Campaign(simulation::Instruments instruments);

  // Takes its invalid readings out first.
  void Add(recording::Recording recording);
  // All of them, in this order; what needs no other run is done at once.
  void Add(std::vector<recording::Recording> recordings);

  // The same runs on a machine whose errors are of other sizes and correlation lengths, its knots
  // so far apart, m; `lines` of the machine file, for all that goes by these.
  Campaign With(const fusion::ErrorPopulation& population,
                const std::array<double, machine::kAxes>& knots,
                const machine::Population& lines) const;

  // The same runs without these readings, which are left out of all that is made of it too.
  Campaign Without(const std::vector<StrayReadings>& strays) const;

  // A campaign without runs, for parts of those of this one or further ones on the same clock.
  Campaign WithoutRuns() const;

  // Terms that were learned on other machines, as candidates beside the known causes.
  void CarryOn(std::vector<std::shared_ptr<const simulation::LearnedCause>> carried);
  const std::vector<std::shared_ptr<const simulation::LearnedCause>>& carried() const {
    return carried_;
  }

  simulation::Origin origin() const;

  // True if at least one run does.
  bool EstimatesNoise() const;
  // Noise of the runs that estimate it, one excess for each run: up where it is a third more, down
  // by a twentieth at least; false where nothing changes.
  enum class Change { kDown, kUp };
  // `excess`: one a run, over the stated noise.
  bool SetExcess(const std::vector<double>& excess, Change change);

  // Noise with a memory, in units of what the run is whitened with (simulation/remembered_noise.h).
  // The run must say what disturbances do (SimulatedRun::response) and have no memory yet.
  void SetMemory(std::size_t run, const estimation::NoiseMemory& noise);

  const simulation::Instruments& instruments() const { return instruments_; }
  const machine::VolumetricModel& model() const { return model_; }
  const fusion::MachinePrior& prior() const { return prior_; }
  // In the order of adding, on one clock.
  const std::vector<PreparedRun>& runs() const { return runs_; }
  simulation::Scene scene() const;
  // How the runs were taken, for the report.
  const std::vector<std::string>& notes() const { return notes_; }
  // On the clock of the campaign; each channel once.
  std::vector<InvalidReadings> invalid_readings() const;

 private:
  // A recording with its valid readings, and those that are not.
  struct Given {
    std::shared_ptr<const recording::Recording> recording;
    std::vector<InvalidReadings> flagged, in_preparing = {};  // on its own clock
  };

  // Flags the strays that are among its readings.
  void LeaveStraysOut(recording::Recording& recording, std::vector<InvalidReadings>& flagged) const;
  void Prepare(std::vector<Given> given);
  void Enter(Given given, simulation::PreparedRuns prepared);
  void NumberRuns();

  simulation::Instruments instruments_;
  machine::VolumetricModel model_;
  fusion::MachinePrior prior_;
  std::optional<simulation::Origin> origin_;  // of the campaign that this is a part of
  simulation::FactsByRun facts_;
  std::vector<StrayReadings> strays_;
  std::vector<Given> given_;
  std::vector<PreparedRun> runs_;
  std::vector<std::string> notes_;
  std::vector<std::shared_ptr<const simulation::LearnedCause>> carried_;
};

}  // namespace abbe::diagnosis
