// What gap sensors read that look from known places at the rim of a turning shaft or wheel.
//
// One reading of one sensor a row. The sensors look towards the axis of rotation. Angles are
// counted in the sense in which the angle of the shaft grows, from the same zero: the point of the
// rim that a sensor sees is the one at place - shaft of the rim's own angle.
// Frames: angles round the axis of the shaft, from the zero of its encoder.
// Units: m, rad. Shapes: one entry per row.
// Failure: none; simulation/shaft/shaft_run.h fills it in.
// Source: docs/shaft.md.
// Validity: gaps small against the radius: a sensor sees one point of the rim.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace abbe::simulation {

inline constexpr int kMostRimSensors = 5;

struct RimReadings {
  int sensors = 0;           // 0: the run is of something else
  std::vector<int> sensor;   // 0, 1, ...: which one
  Eigen::RowVectorXd gap;    // as read; > 0, larger: the rim is farther away
  Eigen::RowVectorXd shaft;  // its angle, on over the end of a turn
  Eigen::RowVectorXd place;  // where the sensor stands
  // What is known by now of what the sensors see, from their zeros: nothing at first.
  Eigen::RowVectorXd seen;                      // m: by what the shaft does
  Eigen::RowVectorXd slope;                     // what they show of a change of it; at first 1
  Eigen::RowVectorXd by_angle, by_angle_twice;  // its derivatives by the angle of the shaft

  // `values` in the rows of one sensor, 0 in others.
  Eigen::RowVectorXd Of(int which, const Eigen::RowVectorXd& values) const {
    Eigen::RowVectorXd own = values;
    for (Eigen::Index row = 0; row < own.size(); ++row) {
      if (sensor[row] != which) own[row] = 0.0;
    }
    return own;
  }
};

}  // namespace abbe::simulation
