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
  MatrixXd columns = MatrixXd::Zero(by_stage_.rows(), disturbances.size());
  for (Index d = 0; d < columns.cols(); ++d) {
    for (const auto& [stage, values] : disturbances[d].stages()) {
      if (stage >= by_stage_.cols()) continue;
      const auto of_stage = by_stage_.col(stage).reshaped(per_instant_, instants());
      columns.col(d).reshaped(per_instant_, instants()) +=
          (of_stage.array().rowwise() * values.array()).matrix();
    }
  }
  return columns;
}

MatrixXd StageResponse::BackToReadings(const MatrixXd& left) const {
  MatrixXd back(left.rows(), left.cols());
  for (Index k = 0; k < per_instant_; ++k) {
    back.middleRows(k * instants(), instants()) =
        left(Eigen::seqN(k, instants(), per_instant_), Eigen::all);
  }
  return back;
}

MatrixXd StageResponse::BackToStage(Index stage, const MatrixXd& back) const {
  MatrixXd of_stage = MatrixXd::Zero(instants(), back.cols());
  if (stage >= by_stage_.cols()) return of_stage;
  for (Index k = 0; k < per_instant_; ++k) {
    const VectorXd slopes = by_stage_(Eigen::seqN(k, instants(), per_instant_), stage);
    of_stage += slopes.asDiagonal() * back.middleRows(k * instants(), instants());
  }
  return of_stage;
}

RowVectorXd StageResponse::WeightsOf(Index stage) const {
  if (stage >= by_stage_.cols()) return RowVectorXd::Zero(instants());
  return by_stage_.col(stage).cwiseAbs2().reshaped(per_instant_, instants()).colwise().sum();
}

}  // namespace abbe::simulation
