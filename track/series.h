// How one number follows temperatures: gains and first-order lags, a random walk and noise, learned
// from a series of it.
//
//   const SeriesResponse response = LearnResponse(series, every_second_block);
//   response.sensors[1].gain, response.sensors[1].lag;
//   const Eigen::VectorXd value = response.value;          // of all rows, also those held out
//
//   z(t) = z_0 + sum over sensors g_s (y_s(t) - y_s(0)) + walk(t) + noise
//
// y_s is the temperature of sensor s behind its lag. Lags, walk and noise are those of the marginal
// likelihood of the rows that are not held out: its maximum, and points beside it,
// sqrt(n + 1) standard deviations along each axis of its curvature, weighted by it (n: how many
// these are). z, g and the walk are
// those of all of these rows, before and after; what they differ by with lags, walk and noise is in
// u.
// Units: those of the series; time in s, lags in s, the walk after an hour. Shapes: rows n;
// temperature sensors x n.
// Failure: InputError for fewer than 12 rows, for times that go back, for values that are not
// finite and for gross jumps: a change from row to row of more than 50 times the usual one.
// Source: gaussian.h; the fixed-interval smoother of Rauch, Tung and Striebel (1965); Rue, Martino and
// Chopin, J. R. Stat. Soc. B 71 (2009), 6.5, for the points beside the maximum.
// Validity: gains and lags are constant; a sensor with a wrong law bends the response.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace abbe::track {

struct Series {
  std::string name;
  Eigen::VectorXd time, value;
  std::vector<std::string> sensors;
  Eigen::MatrixXd temperature;
};

struct SeriesSensor {
  std::string sensor;
  double gain = 0.0, u_gain = 0.0;                  // for each kelvin
  double lag = 0.0, shortest = 0.0, longest = 0.0;  // s; of 95 %
  bool lag_seen = true;  // else it is as long, or as short, as was sought
};

struct SeriesResponse {
  std::vector<SeriesSensor> sensors;
  double walk = 0.0, noise = 0.0;
  Eigen::VectorXd value, u;  // of each row; u of a reading there, noise included
};

// `held_out`: rows that are not used; empty: none.
SeriesResponse LearnResponse(const Series& series, const std::vector<bool>& held_out);

}  // namespace abbe::track
