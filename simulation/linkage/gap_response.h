// What disturbances do to the gaps of a linkage: rows x, y, z of each pose, whitened; stages up to
// kStages, then the encoders. For use within simulation/ only.
#pragma once

#include <Eigen/Core>

#include "simulation/stage_response.h"

namespace abbe::simulation {

class GapResponse : public StageResponse {
 public:
  // `by_stage` as in stage_response.h, `angles` as they were read.
  GapResponse(Eigen::MatrixXd by_stage, Eigen::MatrixXd angles);

  // The angles nearest to those read that leave no gap.
  Eigen::MatrixXd Readings(const Eigen::VectorXd& left) const override;

 private:
  Eigen::MatrixXd angles_;
};

}  // namespace abbe::simulation
