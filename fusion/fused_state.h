// The instruments and mountings that a fit of a map leaves, whose errors those of the map depend
// on.
//
//   map::MapState state = StateAfter(fit, layout, at, model.Blocks(), runs, of_map);
//
// `at`: what the sources of the fit tell at its solution, in the columns of `layout`; `of_map`: the
// covariance of the map, with sizes that are not certain and doubt, which are in its part alone.
// Units: SI; time and sensors are left to the caller. Shapes: those of map/map_state.h.
// Failure: none. For use within fusion/ only.
// Source: map/map_state.h.
// Validity: to first order at the solution.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "estimation/linearization.h"
#include "estimation/result.h"
#include "map/map_state.h"
#include "simulation/simulated_run.h"

namespace abbe::fusion {

map::MapState StateAfter(const estimation::Result& fit, const estimation::Layout& layout,
                         const estimation::Linearization& at,
                         const std::vector<estimation::ParameterBlock>& of_model,
                         const std::vector<simulation::SimulatedRun>& runs,
                         const Eigen::MatrixXd& of_map);

}  // namespace abbe::fusion
