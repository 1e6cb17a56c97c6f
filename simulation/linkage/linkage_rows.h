// What the encoders of a linkage read in the rows of a run: the part of a trace that linkages have.
#pragma once

#include <Eigen/Core>

namespace abbe::simulation {

struct LinkageRows {
  Eigen::MatrixXd angles;   // rad, as read, pivots x rows
  Eigen::MatrixXd turning;  // heading of the pivots: +1, -1; 0: not moved yet
  Eigen::MatrixXd aside;    // rad: of the pivots on their way to rows that stand; linkage_trace.cpp
  Eigen::Matrix3Xd ball_way;  // where the cap last moved, in M: a direction; 0: nowhere
  Eigen::MatrixXd link;       // 3 pivots x rows, in B: the direction of the link after each pivot
  bool is_arm = false;        // no machine carries it
};

}  // namespace abbe::simulation
