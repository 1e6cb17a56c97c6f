// The motion of an axis or a pivot, from the rows of a trace. For use within simulation/ only.
// Units: m or rad, s. Shapes: one entry for each row.
#pragma once

#include <Eigen/Core>

#include "simulation/trace.h"

namespace abbe::simulation {

inline constexpr double kAxisBand = 2e-6;  // m: more than a scale trembles
inline constexpr int kWaySteps = 8;        // of the way between two rows, and before the first

// First and second derivative by time of each row of `values`, from the parabola through three
// neighbours of one pass; 0 where there are none.
struct Derivatives {
  Eigen::MatrixXd first, second;
};
Derivatives DerivativesOf(const Eigen::MatrixXd& values, const Trace& trace);

// The direction of an axis, from its speed where it moves by more than it trembles between two
// rows, else from where it has been.
Eigen::RowVectorXd HeadingOfAxis(const Trace& trace, Eigen::Index axis);

// The heading of each axis of a path, from its positions alone.
Eigen::Matrix3Xd HeadingsOf(const Eigen::Matrix3Xd& path);

// Metres since the heading last changed. Before a pass began the axis moved as it then did. Between
// two rows that stand it turned `beyond` them.
Eigen::RowVectorXd SinceReversal(const Trace& trace, Eigen::Index axis, double beyond = 0.0);

// The output of a play less its input, in widths where it is, for an input that goes from row to row.
Eigen::RowVectorXd PlayOf(const Eigen::RowVectorXd& position, const Trace& trace,
                          const WidthAt& width);
// The same for an encoder that shows its input and what the output stays behind. Between two rows
// that stand the input is beside a straight line by `aside`, kWaySteps x rows, where it is given.
Eigen::RowVectorXd ShownPlayOf(const Eigen::RowVectorXd& shown, const Trace& trace, double width,
                               const Eigen::MatrixXd& aside);

// The same for an encoder that is the output and shows it: the input is known by the way before and
// after, between which the output stands. `heading`: which way it last turned.
Eigen::RowVectorXd LaggingPlayOf(const Eigen::RowVectorXd& shown, const Eigen::RowVectorXd& heading,
                                 const Trace& trace, double width);

}  // namespace abbe::simulation
