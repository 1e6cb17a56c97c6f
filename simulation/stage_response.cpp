#include "simulation/stage_response.h"

#include <utility>

namespace abbe::simulation {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

StageResponse::StageResponse(MatrixXd by_stage, Index per_instant)
    : by_stage_(std::move(by_stage)), per_instant_(per_instant) {}

MatrixXd StageResponse::Columns(const std::vector<Disturbance>& disturbances) const {
  const Index instants = by_stage_.rows() / per_instant_;
  MatrixXd columns = MatrixXd::Zero(by_stage_.rows(), static_cast<Index>(disturbances.size()));
  for (Index d = 0; d < columns.cols(); ++d) {
    for (const auto& [stage, values] : disturbances[static_cast<std::size_t>(d)].stages()) {
      if (stage >= by_stage_.cols()) continue;
      const auto of_stage = by_stage_.col(stage).reshaped(per_instant_, instants);
      columns.col(d).reshaped(per_instant_, instants) +=
          (of_stage.array().rowwise() * values.array()).matrix();
    }
  }
  return columns;
}

Response::RowScores StageResponse::ScoresOf(Index stage, const VectorXd& left) const {
  const Index instants = by_stage_.rows() / per_instant_;
  if (stage >= by_stage_.cols()) {
    return {RowVectorXd::Zero(instants), RowVectorXd::Zero(instants)};
  }
  const VectorXd column = by_stage_.col(stage);
  return {column.cwiseProduct(left).reshaped(per_instant_, instants).colwise().sum(),
          column.cwiseAbs2().reshaped(per_instant_, instants).colwise().sum()};
}

}  // namespace abbe::simulation
