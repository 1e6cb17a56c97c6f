#include "simulation/sweep/sweep_response.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "failure/failure.h"
#include "probes/probe_linearity.h"
#include "simulation/sweep/target_spots.h"

namespace abbe::simulation {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr std::array<Index, 3> kFaceBounds{0, kTopProbes, kProbes};

// How the form of a face correlates between two readings: row g of probe p, row h of probe q.
class FormOfFace {
 public:
  FormOfFace(const SweepPlan& plan, const SweepInstrument& instrument, const SweepRun& run)
      : head_(instrument.head.layout),
        run_(run),
        sign_(plan.chain.ToolSense(run.axis) * plan.R_MH.col(0)[plan.axis]),
        length_(instrument.target.form_length) {}

  double operator()(std::size_t p, Index g, std::size_t q, Index h) const {
    const Eigen::Vector2d apart = PlaceOf(head_, p) - PlaceOf(head_, q);
    const double along = apart[0] + sign_ * (run_.position[g] - run_.position[h]);
    return FormCorrelation(along * along + apart[1] * apart[1], length_);
  }

 private:
  const probes::HeadLayout<>& head_;
  const SweepRun& run_;
  double sign_, length_;
};

// By the gaps that were read; the channels of other probes bring their own characteristic along.
MatrixXd LinearityOf(const probes::HeadSettings& head, const SweepRun& run, Index probe) {
  return probes::LinearityCovariance(run.gap.row(probe).transpose(), head.tolerance.linearity,
                                     head.probes[run.mounted.channels[probe]].range);
}

// cov of the readings of the probes of one face: noise and linearity of each, form of the face for
// all.
MatrixXd FaceCovariance(const SweepPlan& plan, const SweepInstrument& instrument,
                        const SweepRun& run, Index first, Index count) {
  const Index n = run.rows();
  const FormOfFace form(plan, instrument, run);
  const double variance = instrument.target.form * instrument.target.form;
  MatrixXd V = MatrixXd::Zero(n * count, n * count);
  for (Index p = 0; p < count; ++p) {
    for (Index q = 0; q < count; ++q) {
      auto block = V.block(p * n, q * n, n, n);
      for (Index h = 0; h < n && variance > 0.0; ++h) {
        for (Index g = 0; g < n; ++g) block(g, h) = variance * form(first + p, g, first + q, h);
      }
      if (p == q) block += run.covariance[first + p] + LinearityOf(instrument.head, run, first + p);
    }
  }
  return V;
}

// The diagonal of the inverse, L^-T L^-1: the columns of L^-1 begin with zeros.
VectorXd InverseDiagonal(const Eigen::LLT<MatrixXd>& factor) {
  constexpr Index kTogether = 64;
  const Index n = factor.rows();
  const MatrixXd L = factor.matrixL();
  VectorXd diagonal(n);
  for (Index first = 0; first < n; first += kTogether) {
    const Index left = n - first, count = std::min(kTogether, left);
    MatrixXd columns = MatrixXd::Identity(left, count);
    L.bottomRightCorner(left, left).triangularView<Eigen::Lower>().solveInPlace(columns);
    diagonal.segment(first, count) = columns.colwise().squaredNorm();
  }
  return diagonal;
}

}  // namespace

FaceNoise FaceNoiseOf(const SweepPlan& plan, const SweepInstrument& instrument,
                      const SweepRun& run) {
  FaceNoise noise{{}, VectorXd(kProbes * run.rows())};
  for (std::size_t face = 0; face < noise.factors.size(); ++face) {
    const Index first = kFaceBounds[face], count = kFaceBounds[face + 1] - first;
    auto& factor = noise.factors[face];
    const MatrixXd V = FaceCovariance(plan, instrument, run, first, count);
    noise.independent = noise.independent && V.isDiagonal(0.0);
    factor.compute(V);
    if (factor.info() != Eigen::Success) {
      throw InputError(fmt::format(
          "{}: the probes have no noise; state probe_nm in [noise] of the machine file", run.name));
    }
    noise.weights.segment(first * run.rows(), factor.rows()) = InverseDiagonal(factor);
  }
  return noise;
}

ReadingResponse::ReadingResponse(MatrixXd by_motions, MatrixXd gaps, MatrixXd tilts,
                                 std::shared_ptr<const FaceNoise> noise)
    : by_motions_(std::move(by_motions)),
      gaps_(std::move(gaps)),
      tilts_(std::move(tilts)),
      noise_(std::move(noise)) {}

MatrixXd ReadingResponse::Columns(const std::vector<Disturbance>& disturbances) const {
  const Index rows = gaps_.cols();
  MatrixXd columns = MatrixXd::Zero(gaps_.size(), disturbances.size());
  for (Index d = 0; d < columns.cols(); ++d) {
    for (const auto& [stage, values] : disturbances[d].stages()) {
      if (stage >= kReadingStage && stage < kEncoderStage) {
        columns.col(d).segment((stage - kReadingStage) * rows, rows) += values.transpose();
      }
      if (stage >= kToolStage) continue;
      for (Index row = 0; row < rows; ++row) {
        for (Index probe = 0; probe < gaps_.rows(); ++probe) {
          columns(probe * rows + row, d) +=
              by_motions_(probe, row * kToolStage + stage) * values[row];
        }
      }
    }
  }
  WhitenRows(*noise_, columns);
  return columns;
}

MatrixXd ReadingResponse::Readings(const VectorXd& left) const {
  VectorXd off(left.size());
  Index first = 0;
  for (const auto& factor : noise_->factors) {
    off.segment(first, factor.rows()) = factor.matrixL() * left.segment(first, factor.rows());
    first += factor.rows();
  }
  return gaps_ - off.reshaped(gaps_.cols(), gaps_.rows()).transpose();
}

MatrixXd ReadingResponse::BackToReadings(const MatrixXd& left) const {
  MatrixXd back(left.rows(), left.cols());
  Index first = 0;
  for (const auto& factor : noise_->factors) {
    const Index count = factor.rows();
    back.middleRows(first, count) = factor.matrixU().solve(left.middleRows(first, count));
    first += count;
  }
  return back;
}

VectorXd ReadingResponse::SlopesOf(Index probe, Index stage) const {
  const Index rows = gaps_.cols();
  if (stage >= kToolStage) {
    return VectorXd::Constant(rows, stage == kReadingStage + probe ? 1.0 : 0.0);
  }
  const Eigen::RowVectorXd slopes = by_motions_(probe, Eigen::seqN(stage, rows, Index{kToolStage}));
  return slopes.transpose();
}

MatrixXd ReadingResponse::BackToStage(Index stage, const MatrixXd& back) const {
  const Index rows = gaps_.cols();
  if (stage >= kReadingStage && stage < kEncoderStage) {
    return back.middleRows((stage - kReadingStage) * rows, rows);
  }
  MatrixXd of_stage = MatrixXd::Zero(rows, back.cols());
  if (stage >= kToolStage) return of_stage;
  for (Index probe = 0; probe < gaps_.rows(); ++probe) {
    of_stage += SlopesOf(probe, stage).asDiagonal() * back.middleRows(probe * rows, rows);
  }
  return of_stage;
}

Eigen::RowVectorXd ReadingResponse::WeightsOf(Index stage) const {
  const Index rows = gaps_.cols();
  VectorXd weights = VectorXd::Zero(rows);
  for (Index probe = 0; probe < gaps_.rows(); ++probe) {
    weights += SlopesOf(probe, stage)
                   .cwiseAbs2()
                   .cwiseProduct(noise_->weights.segment(probe * rows, rows));
  }
  return weights.transpose();
}

}  // namespace abbe::simulation
