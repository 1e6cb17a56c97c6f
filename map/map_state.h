// What a map that is kept true holds besides its errors: when and how warm the machine was, how its
// errors follow temperatures, how they wander, and the instruments that were measured together with
// them.
//
//   const map::MapState& state = *map.state();
//   state.covariance.topLeftCorner(map.cov_pp().rows(), map.cov_pp().cols());    // is map.cov_pp()
//
// The errors of the map are those at `time` and at the temperatures of `sensors`. A parameter of
// `names` is a response, "response table EXX.linear", in SI for each kelvin, or one of an
// instrument or a mounting, "probe_gain.a", as a later run of it has it.
// Units: SI; temperatures in degC, time in s since 1970. Shapes: P parameters of the map and n of
// `names`: values n, covariance (P + n) x (P + n), those of the map first.
// Failure: InputError by ErrorMap for other shapes and for what is not finite.
// Source: own; a discrete state of a linear system with random walks, Anderson and Moore, Optimal
// Filtering (1979), 2.1.
// Validity: to first order, as the covariance of a map.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "machine/machine.h"

namespace abbe::map {

// A sensor, and the part of the machine that follows it with a lag of first order.
struct Warmth {
  std::string sensor;  // "table": the column temp_table_c
  double lag = 0.0;    // s
  double temperature = 20.0, lagged = 20.0;
};

struct MapState {
  double time = 0.0;
  std::optional<machine::Population> walk = {};  // learned; standard deviations after a day
  std::vector<Warmth> sensors = {};
  std::vector<std::string> names = {};
  Eigen::VectorXd values = {};
  Eigen::MatrixXd covariance = {};
};

}  // namespace abbe::map
