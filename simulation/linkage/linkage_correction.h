// A run of the linkage without causes: its angles and the positions of the axes (correction.h).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "relm/linkage_model.h"
#include "simulation/correction.h"
#include "simulation/instruments.h"

namespace abbe::simulation {

// By how much causes that widen parameters of the model move them.
Eigen::VectorXd ParametersMoved(const relm::LinkageModel& model,
                                const std::vector<ModelledCause>& causes);

Correction CorrectLinkage(const recording::Recording& recording,
                          const std::vector<ModelledCause>& causes, const Origin& origin,
                          const Instruments& on);

}  // namespace abbe::simulation
