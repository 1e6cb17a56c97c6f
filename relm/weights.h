// Where the weights of an arm act, whatever points of its axes are written.
//
//   for (const Weight& weight : WeightsBeyond(chain, joint)) weight.name, weight.point ...
//
// A serial chain knows the lines of its joints and its ball, not how its mass is spread. Taken are
// points that the lines alone define, one for each weight that a joint carries:
//   own    where the link after the joint meets the next axis: the point of that axis nearest to
//          the joint's own
//   wrist  where the last axis comes nearest to the one before it
//   ball   the load
// Where axes are parallel (within kParallel) the point is the one nearest to what follows. A weight
// that keeps on the line of the joint is left out.
// Frames: B, the base, at zero angles.
// Units: m. Shapes: at most three weights a joint.
// Failure: none.
// Source: own; docs/theory-linkage.md, block `weight`.
// Validity: a mass between two of the points acts as shares of it in both; one beside them by as
// much of its lever as it is beside.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "relm/serial_chain.h"

namespace abbe::relm {

struct Weight {
  std::string name;       // "own", "wrist", "ball"
  Eigen::Index carrier;   // the last joint that moves it, from 0
  Eigen::Vector3d point;  // at zero angles
};

inline constexpr double kParallel = 1e-2;  // rad

// `joint` from 0.
std::vector<Weight> WeightsBeyond(const SerialChain& chain, Eigen::Index joint);

}  // namespace abbe::relm
