// What the encoders of a linkage read in the rows of a run: the part of a trace that linkages have.
// Frames: B for `link`, M for the cap.
// Units: rad. Shapes: one column for each row of the run.
// Failure: none; linkage_trace.h fills it in.
// Validity: `behind` needs commanded angles; a table of poses has none.
#pragma once

#include <Eigen/Core>

namespace abbe::simulation {

struct LinkageRows {
  Eigen::MatrixXd angles;   // rad, as read, pivots x rows
  Eigen::MatrixXd behind;   // rad, as read less as commanded; empty where not recorded
  Eigen::MatrixXd heading;  // of the pivots: +1, -1; 0: not moved yet
  // rad: how far a pivot leaves a straight line between its angles in two rows that stand, when the
  // axes go straight from one to the other; kWaySteps rows for each pivot, or empty.
  Eigen::MatrixXd angle_bulge;
  Eigen::Matrix3Xd cap_direction;  // where the cap last moved, in M: a unit vector; 0: nowhere
  Eigen::MatrixXd link;  // 3 pivots x rows, in B: the direction of the link after each pivot
  bool is_arm = false;   // no machine carries it
};

}  // namespace abbe::simulation
