// A map that is kept true: a state that temperatures and time move on, and short tests bring back.
//
//   TrackedMap tracked(mill, map, machine::ReadDrift(document.Root()));
//   tracked.Follow({.time = began, .temperature = {{"table", 22.5}}});
//   const Taken taken = tracked.Take(runs, began);         // runs of one recording
//   const map::ErrorMap now = tracked.Map();
//
// State: the parameters of the map at the present time and temperatures, their gains by each sensor
// (drift_model.h), the parameters of instruments and named mountings that its runs shared, and the
// form of the target at the places that they saw (fusion/target_form.h). From one instant to the
// next
//
//   p -> p + sum over sensors R_s g_s (y_s' - y_s) + w        cov w = (days) V
//
// y_s the temperature of sensor s behind its lag (first_order_lag.h), V the walk of a day. A test
// updates everything with the full covariance (linear_run.h, gaussian.h).
// Frames: map/error_map.h. Units: SI, degC, s since 1970. Shapes: as MapState.
// Failure: InputError for a map without covariance, for a walk that neither the machine file nor
// the map states, for a time before the present one, for a temperature that the map does not know
// or lacks, for a test whose rows do not fit, and for one that contradicts the map: p below 1e-3.
// The state stays as it was.
// Source: Kalman (1960); Anderson and Moore (1979), 6.5.
// Validity: errors that change slowly against the length of a test; a temperature is a straight
// line between its readings; gains and lags are constant.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "machine/drift.h"
#include "machine/machine.h"
#include "map/error_map.h"
#include "simulation/simulated_run.h"
#include "track/gaussian.h"
#include "track/linear_run.h"

namespace abbe::track {

// When, and what the sensors read; one that is not named stays as it was.
struct Conditions {
  double time = 0.0;
  std::map<std::string, double> temperature = {};
};

struct Taken {
  double noise = 1.0;  // of the test, over the stated one
  Agreement agreement = {};
  double log = 0.0;  // of the marginal likelihood
  LinearTest test;   // entries as State() has them
};

// Agreement below which a test contradicts the map.
inline constexpr double kContradiction = 1e-3;
// Noise over the stated one above which the rows of a test do not fit, as chi-square above 9.
inline constexpr double kDoesNotFit = 3.0;

class TrackedMap {
 public:
  // A walk that the map has learned stands before that of `drift`, a lag that `drift` states before
  // one that was learned. A map without a state begins with the conditions `begin`.
  TrackedMap(const machine::Machine& machine, const map::ErrorMap& map, const machine::Drift& drift,
             const Conditions& begin = {});

  double time() const { return time_; }
  const std::vector<map::Warmth>& sensors() const { return sensors_; }
  const std::vector<std::string>& names() const { return names_; }
  const Gaussian& state() const { return state_; }
  const machine::Population& walk() const { return walk_; }

  // Time and temperatures go on.
  void Follow(const Conditions& conditions);
  // A recording that begins at `began`, with the temperatures that were followed so far.
  Taken Take(const std::vector<simulation::SimulatedRun>& runs, double began);
  // The same test again.
  double Take(const LinearTest& test);
  // What outlives the runs becomes part of the state, with the priors of the machine file.
  void Know(std::vector<simulation::SimulatedRun> runs);
  // The runs as a linear test, which is not taken.
  LinearRun Test(std::vector<simulation::SimulatedRun> runs);

  // Another walk, and other lags in the order of the sensors, before anything is followed.
  void SetWalk(const machine::Population& walk);
  void SetLag(std::size_t sensor, double lag);

  map::ErrorMap Map() const;

 private:
  void AddParameters(const std::vector<std::string>& names, const Eigen::VectorXd& mean,
                     const Eigen::VectorXd& deviations);
  void AddInstruments(const std::vector<simulation::SimulatedRun>& runs);
  void AddSensors(const machine::Drift& drift, const Conditions& begin);
  void Move();

  machine::Machine machine_;
  map::MapOrigin origin_;
  machine::VolumetricModel model_;
  std::vector<std::string> names_;  // of the whole state
  Gaussian state_;
  double time_ = 0.0, moved_ = 0.0;  // moved_: that of the state
  std::vector<map::Warmth> sensors_;
  std::vector<double> at_;  // lagged temperatures of the state
  std::vector<Eigen::MatrixXd> shapes_;
  std::vector<Eigen::Index> gains_;  // where those of a sensor begin
  machine::Population walk_;
  bool learned_ = false;  // the walk; else that of the machine file
  Eigen::MatrixXd day_;   // root of V
};

}  // namespace abbe::track
