// The noise of the five probes in a sweep, and what disturbances of its rows do to their readings.
//
// Rows: all of probe a, then of b, ...; the three top probes share the form of one face, the two
// side probes that of the other. Units: m. Failure: InputError for probes without noise. For use
// within simulation/ only.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "simulation/simulated_run.h"
#include "simulation/sweep/sweep_reading.h"
#include "simulation/sweep/sweep_simulation.h"

namespace abbe::simulation {

struct FaceNoise {
  std::array<Eigen::LLT<Eigen::MatrixXd>, 2> factors;  // of the covariance of each face
  Eigen::VectorXd weights;                             // diagonal of the inverse
  bool independent = true;                             // from row to row
};

FaceNoise FaceNoiseOf(const SweepPlan& plan, const SweepInstrument& instrument,
                      const SweepRun& run);

template <typename Columns>
void WhitenRows(const FaceNoise& noise, Columns& columns) {
  Eigen::Index first = 0;
  for (const auto& factor : noise.factors) {
    auto rows = columns.middleRows(first, factor.rows());
    if (!rows.isZero(0.0)) factor.matrixL().solveInPlace(rows);
    first += factor.rows();
  }
}

class ReadingResponse : public Response {
 public:
  // `by_motions`: 5 x 18 of each row, side by side; `gaps` as read and `tilts`, 5 x rows.
  ReadingResponse(Eigen::MatrixXd by_motions, Eigen::MatrixXd gaps, Eigen::MatrixXd tilts,
                  std::shared_ptr<const FaceNoise> noise);

  Eigen::MatrixXd Columns(const std::vector<Disturbance>& disturbances) const override;
  Eigen::MatrixXd Readings(const Eigen::VectorXd& left) const override;
  Eigen::MatrixXd Tilts() const override { return tilts_; }
  Eigen::MatrixXd BackToReadings(const Eigen::MatrixXd& left) const override;
  Eigen::MatrixXd BackToStage(Eigen::Index stage, const Eigen::MatrixXd& back) const override;
  Eigen::RowVectorXd WeightsOf(Eigen::Index stage) const override;
  bool RowsAreIndependent() const override { return noise_->independent; }

 private:
  // By how much a probe changes in each row.
  Eigen::VectorXd SlopesOf(Eigen::Index probe, Eigen::Index stage) const;

  Eigen::MatrixXd by_motions_, gaps_, tilts_;
  std::shared_ptr<const FaceNoise> noise_;
};

}  // namespace abbe::simulation
