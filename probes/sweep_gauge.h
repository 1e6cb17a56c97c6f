// The gauge of a sweep: the constants that a sweep does not determine, removed in one way
// everywhere. An angle is counted from the first station, a straightness from its least-squares
// line, whose slope is mounting tilt and squareness.
//
// A gauge is linear, y = G x, over the groups of a sweep, which are numbered station * directions +
// k. Its reference is the mean of the directions, so it leaves a reversal error unchanged.
// Units: those of the values. Shapes: values are groups x any number of columns.
// Failure: none.
// Source: own.
// Validity: exact, for any stations; equal weight for each of them.
#pragma once

#include <Eigen/Core>

namespace abbe::probes {

class SweepGauge {
 public:
  enum class Kind { kFirstStation, kLine };

  // `stations`: m, at least two different ones.
  SweepGauge(const Eigen::VectorXd& stations, Eigen::Index directions);

  // G values.
  Eigen::MatrixXd Apply(Kind kind, const Eigen::MatrixXd& values) const;
  // G V G^T, V groups x groups.
  Eigen::MatrixXd Covariance(Kind kind, const Eigen::MatrixXd& covariance) const;
  // The mean over the directions: stations x columns of `values`.
  Eigen::MatrixXd StationMeans(const Eigen::MatrixXd& values) const;
  // The slope of the least-squares line is slope_weights . values, 1/m.
  const Eigen::VectorXd& slope_weights() const { return slope_weights_; }

 private:
  Eigen::VectorXd position_;  // m, per group, from the mean of the stations
  Eigen::VectorXd slope_weights_;
  Eigen::Index directions_;
};

}  // namespace abbe::probes
