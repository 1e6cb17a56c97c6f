// Many inversions of readings that lie as an array of rows has them: five numbers of one station after
// the other.
//
//   const SmallAngleInversion invert(layout, MovingBody::kTarget);
//   Eigen::Matrix<double, 6, Eigen::Dynamic> errors(6, readings.cols());
//   InvertRows(invert, readings, travels, Eigen::VectorXd(), errors);
//
// Blocks of stations that fit into the first-level cache are turned, inverted by
// SmallAngleInversion::Invert and turned back.
// Frames: H, as in head_model.h. Units: m and rad.
// Shapes: readings 5 x n in the order A, B, C, D, E; travel n; EXX n, or empty for zero; errors 6 x n,
// in the order of HeadErrors, of that size before the call.
// Failure: that of SmallAngleInversion::Invert, of the first station that is refused; InputError for
// sizes that differ. An interruption (failure/interruption.h) ends it between two blocks.
// Source: head_inversion.h. Validity: that of head_inversion.h.
#pragma once

#include <Eigen/Core>

#include "probes/head_inversion.h"

namespace abbe::probes {

using ReadingRows = Eigen::Matrix<double, static_cast<int>(kProbes), Eigen::Dynamic>;
using ErrorRows = Eigen::Matrix<double, 6, Eigen::Dynamic>;

void InvertRows(const SmallAngleInversion& inversion, const Eigen::Ref<const ReadingRows>& readings,
                const Eigen::Ref<const Eigen::VectorXd>& d,
                const Eigen::Ref<const Eigen::VectorXd>& exx, Eigen::Ref<ErrorRows> errors);

}  // namespace abbe::probes
