// Recorded positions of the axes, held inside the travels: where the errors of the machine are taken
// from, not where the axes stand.
//
// A scale at the end of its travel shows some micrometres more or less; that far the errors of the
// end are meant, which change by less than a nanometre over it. Units: m. Shapes: [x y z] in
// columns. Failure: InputError with recording, row and axis for a position farther outside: nothing
// is known of the machine there.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "machine/volumetric_model.h"

namespace abbe::simulation {

inline constexpr double kEndWindow = 5e-6;  // m

// `rows` of the recording, from 0, one for each column; for the message only.
Eigen::Matrix3Xd AxesInTravel(const machine::VolumetricModel& model, const Eigen::Matrix3Xd& axes,
                              const std::string& recording, const std::vector<std::size_t>& rows);

}  // namespace abbe::simulation
