#include "track/tracked_map.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "failure/failure.h"
#include "fusion/machine_problem.h"
#include "fusion/reversals.h"
#include "fusion/target_form.h"
#include "recording/instant.h"
#include "track/drift_model.h"
#include "track/first_order_lag.h"

namespace abbe::track {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kSecondsOfDay = 86400.0;
constexpr double kClockSlack = 1.0;  // s: instants in files are whole seconds

// No response without one of its own is stated for a sensor that only the map names.
const machine::Population kNoResponse{};

}  // namespace

TrackedMap::TrackedMap(const machine::Machine& machine, const map::ErrorMap& map,
                       const machine::Drift& drift, const Conditions& begin)
    : machine_(machine), origin_(map.origin()), model_(map.model()) {
  if (!map.StatesUncertainty()) {
    throw InputError("the map of " + origin_.machine +
                     " has no covariance, so nothing says how far a test may move it; fuse its "
                     "runs to get one");
  }
  if (origin_.machine != machine.name) {
    throw InputError(fmt::format("the map is of the machine \"{}\", the machine file of \"{}\"",
                                 origin_.machine, machine.name));
  }
  names_ = map.ParameterNames();
  map::MapState before;
  if (map.state()) {
    before = *map.state();
  } else {
    before.time = begin.time;
    before.covariance = map.cov_pp();
    if (!(begin.time > 0.0)) {
      throw InputError("the map does not say when it was measured; give --measured INSTANT");
    }
  }
  names_.insert(names_.end(), before.names.begin(), before.names.end());
  VectorXd mean(names_.size());
  mean << map.model().Parameters(), before.values;
  state_ = MakeGaussian(mean, before.covariance);
  time_ = moved_ = before.time;
  sensors_ = before.sensors;
  AddSensors(drift, begin);
  if (!drift.walk && !before.walk) {
    throw InputError(
        "nothing says how much the machine changes from day to day: state [drift] in the machine "
        "file, or learn it with --learn from a history of short tests");
  }
  SetWalk(before.walk ? *before.walk : *drift.walk);
  learned_ = before.walk.has_value();
}

void TrackedMap::AddSensors(const machine::Drift& drift, const Conditions& begin) {
  for (const machine::SensorDrift& each : drift.sensors) {
    auto known = std::find_if(sensors_.begin(), sensors_.end(),
                              [&](const auto& sensor) { return sensor.sensor == each.sensor; });
    if (known == sensors_.end()) {
      const auto given = begin.temperature.find(each.sensor);
      if (given == begin.temperature.end()) {
        throw InputError(fmt::format(
            "the map does not say how warm \"{}\" was; the runs that were fused have no column "
            "temp_{}_c: give --then {}=DEGREES",
            each.sensor, each.sensor, each.sensor));
      }
      sensors_.push_back({each.sensor, 0.0, given->second, given->second});
      known = sensors_.end() - 1;
    }
    if (each.lag) known->lag = *each.lag;
  }
  // A sensor that was read when the runs were fused and that nothing is said to follow.
  std::erase_if(sensors_, [&](const map::Warmth& sensor) {
    const std::string block = fmt::format("response {} ", sensor.sensor);
    return std::none_of(drift.sensors.begin(), drift.sensors.end(),
                        [&](const auto& each) { return each.sensor == sensor.sensor; }) &&
           std::none_of(names_.begin(), names_.end(),
                        [&](const auto& name) { return name.starts_with(block); });
  });
  for (const map::Warmth& sensor : sensors_) {
    const auto stated =
        std::find_if(drift.sensors.begin(), drift.sensors.end(),
                     [&](const auto& each) { return each.sensor == sensor.sensor; });
    Response response = ResponseOf(sensor.sensor, model_,
                                   stated == drift.sensors.end() ? kNoResponse : stated->by_kelvin);
    const auto first = std::find(names_.begin(), names_.end(), response.names.front());
    gains_.push_back(first - names_.begin());
    if (first == names_.end()) {
      AddParameters(response.names, VectorXd::Zero(response.deviations.size()),
                    response.deviations);
    }
    shapes_.push_back(std::move(response.shapes));
    at_.push_back(sensor.lagged);
  }
}

void TrackedMap::AddParameters(const std::vector<std::string>& names, const VectorXd& mean,
                               const VectorXd& deviations) {
  const Index before = state_.mean.size(), more = mean.size();
  names_.insert(names_.end(), names.begin(), names.end());
  VectorXd all(before + more);
  all << state_.mean, mean;
  MatrixXd root = MatrixXd::Zero(before + more, before + more);
  root.topLeftCorner(before, before) = state_.root;
  root.bottomRightCorner(more, more) = deviations.asDiagonal();
  state_ = {std::move(all), std::move(root)};
}

void TrackedMap::SetWalk(const machine::Population& walk) {
  walk_ = walk;
  learned_ = true;
  day_ = WalkRoot(machine_, model_, walk);
}

void TrackedMap::SetLag(std::size_t sensor, double lag) { sensors_[sensor].lag = lag; }

void TrackedMap::Follow(const Conditions& conditions) {
  for (const auto& [name, value] : conditions.temperature) {
    const auto known =
        std::find_if(sensors_.begin(), sensors_.end(),
                     [sought = name](const auto& each) { return each.sensor == sought; });
    if (known == sensors_.end()) {
      std::vector<std::string> all;
      for (const map::Warmth& each : sensors_) all.push_back(each.sensor);
      throw InputError(fmt::format("the map knows no temperature \"{}\"; it follows {}", name,
                                   all.empty()
                                       ? "none: state [drift.temperature.NAME] in the machine file"
                                       : fmt::format("{}", fmt::join(all, ", "))));
    }
    if (!std::isfinite(value)) {
      throw InputError(fmt::format("the temperature of \"{}\" is not a number", name));
    }
  }
  const double seconds = conditions.time - time_;
  if (!(seconds > -kClockSlack)) {
    throw InputError(fmt::format(
        "{} lies before {}, where the map stands already: a clock jumped back, or the tests are "
        "out of order",
        recording::InstantText(conditions.time), recording::InstantText(time_)));
  }
  for (map::Warmth& each : sensors_) {
    const auto now = conditions.temperature.find(each.sensor);
    const double to = now == conditions.temperature.end() ? each.temperature : now->second;
    // Between two readings of one instant the later one counts.
    each.lagged = LagAfter(each.lagged, each.temperature, to, std::max(seconds, 0.0), each.lag);
    each.temperature = to;
  }
  time_ = std::max(time_, conditions.time);
}

void TrackedMap::Move() {
  const Index parameters = day_.rows();
  for (std::size_t s = 0; s < sensors_.size(); ++s) {
    const double warmer = sensors_[s].lagged - at_[s];
    at_[s] = sensors_[s].lagged;
    if (warmer == 0.0) continue;
    const Index count = shapes_[s].cols();
    state_.mean.head(parameters) += warmer * shapes_[s] * state_.mean.segment(gains_[s], count);
    state_.root.topRows(parameters) +=
        warmer * shapes_[s] * state_.root.middleRows(gains_[s], count);
  }
  const double days = (time_ - moved_) / kSecondsOfDay;
  moved_ = time_;
  // What does not walk has no part in the first columns (MakeGaussian).
  state_.root.topLeftCorner(parameters, parameters) =
      RootOfSum(state_.root.topLeftCorner(parameters, parameters), std::sqrt(days) * day_);
}

void TrackedMap::Know(std::vector<simulation::SimulatedRun> runs) {
  for (simulation::SimulatedRun& run : runs) fusion::WithForm(run);
  AddInstruments(runs);
}

void TrackedMap::AddInstruments(const std::vector<simulation::SimulatedRun>& runs) {
  std::vector<std::string> names;
  std::vector<double> mean, deviations;
  for (const simulation::SimulatedRun& run : runs) {
    for (const estimation::ParameterBlock& block : run.blocks) {
      if (!fusion::OutlivesRuns(block, runs)) continue;
      for (std::size_t i = 0; i < block.entries.size(); ++i) {
        const estimation::Parameter& entry = block.entries[i];
        const std::string name = block.FullName(i);
        if (entry.held || !(entry.prior_sd < estimation::kNoPrior) ||
            std::find(names_.begin(), names_.end(), name) != names_.end() ||
            std::find(names.begin(), names.end(), name) != names.end()) {
          continue;
        }
        names.push_back(name);
        mean.push_back(entry.nominal);
        deviations.push_back(entry.prior_sd);
      }
    }
  }
  const Index more = names.size();
  if (more == 0) return;
  AddParameters(names, Eigen::Map<const VectorXd>(mean.data(), more),
                Eigen::Map<const VectorXd>(deviations.data(), more));
}

LinearRun TrackedMap::Test(std::vector<simulation::SimulatedRun> runs) {
  for (simulation::SimulatedRun& run : runs) fusion::WithForm(run);
  AddInstruments(runs);
  Move();
  for (simulation::SimulatedRun& run : runs) fusion::WithReversals(machine_, run);
  return Linearize(std::move(runs), names_, state_);
}

Taken TrackedMap::Take(const std::vector<simulation::SimulatedRun>& runs, double began) {
  if (began < moved_ - kClockSlack) {
    throw InputError(fmt::format(
        "{} began at {}, before {}, where the map stands already: a clock jumped back, or the "
        "tests are out of order",
        runs.front().name, recording::InstantText(began), recording::InstantText(moved_)));
  }
  LinearRun linear = Test(runs);
  Taken taken{.noise = linear.noise,
              .agreement = AgreementOf(linear.test, state_),
              .log = 0.0,
              .test = std::move(linear.test)};
  if (linear.unexplained > kDoesNotFit) {
    throw InputError(fmt::format(
        "{}: its rows scatter {:.1f} times the noise that is stated: it is no measurement of this "
        "machine as the map has it; diagnose it, or state its noise",
        runs.front().name, linear.unexplained));
  }
  if (taken.noise > kDoesNotFit || taken.agreement.probability < kContradiction) {
    throw InputError(fmt::format(
        "{}: contradicts the map (chi-square {:.0f} for {} directions, p = {:.2g}): more than "
        "[drift] explains has changed, by a collision or service, or the test has another mounting "
        "or instrument than it says; diagnose the test, or measure and fuse anew",
        runs.front().name, taken.agreement.statistic, taken.agreement.directions,
        taken.agreement.probability));
  }
  taken.log = Measure(taken.test, state_);
  return taken;
}

double TrackedMap::Take(const LinearTest& test) {
  Move();
  return Measure(test, state_);
}

map::ErrorMap TrackedMap::Map() const {
  TrackedMap now = *this;
  now.Move();
  const MatrixXd all = now.state_.Covariance();
  const Index parameters = day_.rows(), more = all.rows() - parameters;
  machine::VolumetricModel model = model_;
  model.SetParameters(now.state_.mean.head(parameters));
  map::MapState state{.time = time_,
                      .walk = learned_ ? std::optional(walk_) : std::nullopt,
                      .sensors = sensors_,
                      .names = {names_.begin() + parameters, names_.end()},
                      .values = now.state_.mean.tail(more),
                      .covariance = all};
  return {origin_, std::move(model), all.topLeftCorner(parameters, parameters), std::move(state)};
}

}  // namespace abbe::track
