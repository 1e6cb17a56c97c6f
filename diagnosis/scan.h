// The wave number and the interval of a variable at which the residual of channels is strongest.
//
//   const Scan scan{values, scores, weights};
//   const std::vector<double> waves = StrongestWaves(scan, step);
//   const std::vector<Interval> where = StrongestIntervals(scan);
//
// Among many functions f of a variable, that with the largest score^2 / information, where score
// and largest information are those of Fit::ScoresOf: enough to choose by. What is chosen is then
// asked as it should be. Source: periodogram with unequal times, Lomb, Astrophys. Space Sci. 39
// (1976); a change at unknown places, Siegmund, Sequential Analysis (1985).
#pragma once

#include <Eigen/Core>
#include <vector>

namespace abbe::diagnosis {

inline constexpr Eigen::Index kLines = 400;  // waves, and cells of the range, that are tried
inline constexpr double kIntervals = 0.5 * kLines * (kLines + 1);

struct Scan {
  Eigen::RowVectorXd values;        // of the variable, one per row of the runs
  Eigen::MatrixXd scores, weights;  // a line for each channel
};

struct Interval {
  double from = 0.0, to = 0.0;  // in the unit of the variable, without `to`; empty: none

  bool IsEmpty() const { return !(to > from); }
};

// Among the waves step, 2 step ... kLines step (rad per unit of the variable); 0: nothing there.
std::vector<double> StrongestWaves(const Scan& scan, double step);

// Between the borders of kLines cells of the range.
std::vector<Interval> StrongestIntervals(const Scan& scan);

}  // namespace abbe::diagnosis
