// Where causes that no map holds bring the axes along a path of commands: what a performance
// simulation and the correction of measured coordinates add to the map.
//
//   const Eigen::Matrix3Xd beside = PathDisplacement(path, 10e-3, model.causes);
//
// Frames, units: axis positions [x y z], m; `feed` in m/s, 0: the axes stand at each point, so that
// nothing lags. Points that the feed takes more than half a second for are stops too. Only causes
// of the seat kMotion that follow the path act: a path knows neither time nor temperature. Shapes:
// 3 x points, as the path.
// Failure: none.
// Source: docs/extended-model.md; docs/correct.md.
// Validity: the axis comes to the first point as it goes on from there.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "simulation/extended_model.h"

namespace abbe::simulation {

// Seat kMotion, neither time nor temperature, and known by more than its size.
bool ActsOnPath(const ModelledCause& cause);

// Causes that do not act on a path add nothing.
Eigen::Matrix3Xd PathDisplacement(const Eigen::Matrix3Xd& path, double feed,
                                  const std::vector<ModelledCause>& causes);

}  // namespace abbe::simulation
