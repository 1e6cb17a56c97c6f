#include "simulation/linkage/gap_response.h"

#include <Eigen/Dense>
#include <utility>

namespace abbe::simulation {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

GapResponse::GapResponse(MatrixXd by_stage, MatrixXd angles)
    : StageResponse(std::move(by_stage), 3), angles_(std::move(angles)) {}

MatrixXd GapResponse::Readings(const Eigen::VectorXd& left) const {
  MatrixXd angles = angles_;
  for (Index pose = 0; pose < angles.cols(); ++pose) {
    const MatrixXd by_angles = by_stage().middleRows<3>(3 * pose).rightCols(angles.rows());
    angles.col(pose) -=
        by_angles.completeOrthogonalDecomposition().solve(Vector3d(left.segment<3>(3 * pose)));
  }
  return angles;
}

}  // namespace abbe::simulation
