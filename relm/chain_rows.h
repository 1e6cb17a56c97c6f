// A chain as its machine file writes it, in Denavit-Hartenberg rows or as axes, with the numbers of
// another chain: what a calibration found of an arm.
//
//   const WrittenChain nominal = WrittenChain::Of(settings);
//   const WrittenChain found = nominal.With(model.ChainAt(x));
//   found.Chain().Tip(q);                            // found.X_BW.Inverse() * the tip of the chain
//
// Where the base frame of an arm stands is open: the first axis stays where it was, and so does the
// place and the turn about it at which the second one follows (theta and d of the first row). Of
// the last row the ball tells nothing that its place in the last frame does not: the row stays. Two
// axes that are written parallel (within kParallel) have no common normal that is known: d stays,
// and the tilt of the second about the y axis of its frame is a fixed row of its own behind
// (Hayati's parameter: theta 90 degrees, alpha the tilt), with 90 degrees less theta in the next.
// Frames: B, the base of the chain; W, that of the written one.
// Units: m, rad. Shapes: Numbers(): 4 a row or 6 an axis, then the ball.
// Failure: InputError for another number of joints, fixed rows elsewhere than at the two ends or as
// said above, axes written on one line.
// Source: Hayati, Mirmirani, Improving the absolute positioning accuracy of robot manipulators, J.
// Robotic Systems 2 (1985).
// Validity: exact.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/transform.h"
#include "relm/linkage_settings.h"
#include "relm/serial_chain.h"

namespace abbe::relm {

struct WrittenChain {
  std::vector<DenavitHartenbergRow> rows;  // empty: written as axes
  std::vector<JointAxis> axes;             // empty: written as rows
  Eigen::Vector3d ball;                    // in the frame of the last row; of axes in W
  geometry::Transform<double> X_BW = {};

  // InputError for forms that are neither rows nor axes.
  static WrittenChain Of(const LinkageSettings& settings);

  // In this form, near these numbers.
  WrittenChain With(const SerialChain& chain) const;
  // In the frame W in which it is written.
  SerialChain Chain() const;
  // What is written: theta, d, a, alpha of each row, or point and direction of each axis; the ball.
  Eigen::VectorXd Numbers() const;
};

}  // namespace abbe::relm
