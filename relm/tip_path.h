// The path of the ball from a recording of the encoders, by direct evaluation.
//
//   const TipPath path = EvaluateTipPath(recording, settings, model, model.Values());
//   path.tips;                     // 3 x poses, in B
//   InFrame(X_MB, path.tips);      // in M
//
// Reads the columns pivot_1_rad ... pivot_N_rad and, where the recording has it, the temperature
// column of the settings. Rows with a flag other than 0 are left out; `rows` are the indices of the
// others, for their positions, pass and direction.
// Frames: B, the linkage base; T the ball.
// Units: m, rad, s. Shapes: one column per pose.
// Failure: InputError with the recording's name for a missing column, an angle that is not finite
// in a row without a flag, or no such row. A step of more than half a turn between neighbouring
// rows is an InputError too: the encoder has wrapped or slipped there.
// Source: docs/theory-linkage.md.
// Validity: that of the model.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "geometry/transform.h"
#include "recording/recording.h"
#include "relm/linkage_model.h"
#include "relm/linkage_settings.h"

namespace abbe::relm {

// The encoder readings of the good rows of a recording.
struct GoodReadings {
  LinkageReadings readings;
  std::vector<std::size_t> rows;  // of the recording, in its order
  std::size_t flagged = 0;        // rows left out
};
// The rows without a flag, checked as above.
GoodReadings ReadAngles(const recording::Recording& recording, const LinkageSettings& settings);

struct TipPath {
  Eigen::Matrix3Xd tips;          // p_BT, m
  std::vector<std::size_t> rows;  // of the recording
  std::size_t flagged = 0;
};
// `x`: parameters of the model; model.Values() for the nominal ones.
TipPath EvaluateTipPath(const recording::Recording& recording, const LinkageSettings& settings,
                        const LinkageModel& model, const Eigen::VectorXd& x);

// p_AT = X_AB p_BT for each column.
Eigen::Matrix3Xd InFrame(const geometry::Transform<double>& X_AB, const Eigen::Matrix3Xd& p_BT);

}  // namespace abbe::relm
