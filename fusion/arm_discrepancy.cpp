#include "fusion/arm_discrepancy.h"

#include <algorithm>
#include <cmath>

#include "estimation/variance_parts.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using estimation::VariancePart;
using estimation::VarianceSizes;

constexpr double kElse = 0.05;     // probability that there is such a thing, before the data
constexpr double kByChance = 2.0;  // log likelihood that fields gain of white noise
constexpr Index kMostPoses = 80;   // that the sizes are estimated from
constexpr Index kMostCounted = 1500;

struct Field {
  enum class Over { kOwnAngle, kAllAngles, kEachPose, kTime };
  Over over;
  Index pivot;    // that turns; with kTime the ball moves
  double length;  // chord; of the time of the run
};

// The poses of all runs.
struct Poses {
  ArmLeft all;  // `time`: in the time of its run
  Eigen::VectorXi run;
  Index size() const { return run.size(); }
  Index pivots() const { return all.angles.rows(); }
};

Poses Together(const std::vector<ArmLeft>& runs) {
  Index poses = 0;
  for (const ArmLeft& run : runs) poses += run.time.size();
  const ArmLeft& first = runs.front();
  Poses together{
      {MatrixXd(first.angles.rows(), poses), VectorXd(poses), VectorXd(3 * poses),
       MatrixXd(3 * poses, first.by_parameters.cols()), MatrixXd(3 * poses, first.by_stage.cols())},
      Eigen::VectorXi(poses)};
  Index at = 0;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const ArmLeft& run = runs[r];
    const Index size = run.time.size();
    const double span = run.time.maxCoeff() - run.time.minCoeff();
    together.all.angles.middleCols(at, size) = run.angles;
    together.all.time.segment(at, size) =
        (run.time.array() - run.time.minCoeff()) / (span > 0.0 ? span : 1.0);
    together.all.left.segment(3 * at, 3 * size) = run.left;
    together.all.by_parameters.middleRows(3 * at, 3 * size) = run.by_parameters;
    together.all.by_stage.middleRows(3 * at, 3 * size) = run.by_stage;
    together.run.segment(at, size).setConstant(static_cast<int>(r));
    at += size;
  }
  return together;
}

// At most so many, evenly.
Poses Thinned(const Poses& poses, Index most) {
  if (poses.size() <= most) return poses;
  std::vector<Index> kept, rows;
  for (Index i = 0; i < most; ++i) {
    kept.push_back(i * poses.size() / most);
    for (Index k = 0; k < 3; ++k) rows.push_back(3 * kept.back() + k);
  }
  const ArmLeft& all = poses.all;
  return {{all.angles(Eigen::all, kept), all.time(kept), all.left(rows),
           all.by_parameters(rows, Eigen::all), all.by_stage(rows, Eigen::all)},
          poses.run(kept)};
}

double Alike(const Field& field, const Poses& poses, Index i, Index j) {
  const auto chord_square = [&](Index pivot) {
    const double half = 0.5 * (poses.all.angles(pivot, i) - poses.all.angles(pivot, j));
    return 4.0 * std::sin(half) * std::sin(half);
  };
  double square = 0.0;
  switch (field.over) {
    case Field::Over::kEachPose:
      return i == j ? 1.0 : 0.0;
    case Field::Over::kTime:
      return poses.run[i] != poses.run[j]
                 ? 0.0
                 : std::exp(-std::abs(poses.all.time[i] - poses.all.time[j]) / field.length);
    case Field::Over::kOwnAngle:
      square = chord_square(field.pivot);
      break;
    case Field::Over::kAllAngles:
      for (Index pivot = 0; pivot < poses.pivots(); ++pivot) square += chord_square(pivot);
  }
  return std::exp(-square / (2.0 * field.length * field.length));
}

MatrixXd CorrelationOf(const Field& field, const Poses& poses) {
  MatrixXd correlation(poses.size(), poses.size());
  for (Index j = 0; j < poses.size(); ++j) {
    for (Index i = j; i < poses.size(); ++i) {
      correlation(i, j) = correlation(j, i) = Alike(field, poses, i, j);
    }
  }
  return correlation;
}

std::vector<Index> StagesOf(const Field& field, const Poses& poses) {
  if (field.over != Field::Over::kTime) return {field.pivot};
  return {poses.pivots(), poses.pivots() + 1, poses.pivots() + 2};
}

// What a field of size 1 makes of the rows.
MatrixXd CovarianceOf(const Field& field, const Poses& poses) {
  const MatrixXd correlation = CorrelationOf(field, poses);
  MatrixXd covariance = MatrixXd::Zero(3 * poses.size(), 3 * poses.size());
  for (const Index stage : StagesOf(field, poses)) {
    const auto by = poses.all.by_stage.col(stage);
    for (Index j = 0; j < poses.size(); ++j) {
      for (Index i = 0; i < poses.size(); ++i) {
        covariance.block<3, 3>(3 * i, 3 * j) +=
            correlation(i, j) * by.segment<3>(3 * i) * by.segment<3>(3 * j).transpose();
      }
    }
  }
  return covariance;
}

// C J' K J C: `moved` is J C.
MatrixXd CovarianceOfEstimates(const Field& field, const Poses& poses, const MatrixXd& moved) {
  const MatrixXd correlation = CorrelationOf(field, poses);
  MatrixXd covariance = MatrixXd::Zero(moved.cols(), moved.cols());
  for (const Index stage : StagesOf(field, poses)) {
    MatrixXd by_pose(poses.size(), moved.cols());
    for (Index i = 0; i < poses.size(); ++i) {
      by_pose.row(i) =
          poses.all.by_stage.col(stage).segment<3>(3 * i).transpose() * moved.middleRows<3>(3 * i);
    }
    const MatrixXd spread = correlation * by_pose;
    covariance += by_pose.transpose() * spread;
  }
  return covariance;
}

// A pivot that does not move the ball has none.
std::vector<Field> FieldsOf(const Poses& poses) {
  constexpr double kMoves = 1e-3;  // of the pivot that moves it most
  std::vector<Field> fields;
  const VectorXd moves = poses.all.by_stage.leftCols(poses.pivots()).colwise().norm();
  for (Index pivot = 0; pivot < poses.pivots(); ++pivot) {
    if (moves[pivot] < kMoves * moves.maxCoeff()) continue;
    for (const double length : {1.0, 4.0}) {
      fields.push_back({Field::Over::kOwnAngle, pivot, length});
      fields.push_back({Field::Over::kAllAngles, pivot, length});
    }
    fields.push_back({Field::Over::kEachPose, pivot, 0.0});
  }
  if (poses.all.time.maxCoeff() > 0.0) {
    for (const double length : {0.1, 0.5}) fields.push_back({Field::Over::kTime, 0, length});
  }
  return fields;
}

}  // namespace

Discrepancy DiscrepancyOf(const std::vector<ArmLeft>& runs, const VectorXd& prior_sd,
                          const VectorXd& off, const MatrixXd& covariance, double least) {
  const Poses all = Together(runs), few = Thinned(all, kMostPoses);
  const std::vector<Field> fields = FieldsOf(few);
  const MatrixXd by_priors = few.all.by_parameters * prior_sd.asDiagonal();
  const MatrixXd prior = by_priors * by_priors.transpose();
  const VectorXd left = few.all.left - few.all.by_parameters * off;
  const Index rows = left.size();
  std::vector<VariancePart> parts{{MatrixXd::Identity(rows, rows), least}};
  const VarianceSizes noise = EstimateVariances(prior, parts, left);
  for (const Field& field : fields) parts.push_back({CovarianceOf(field, few), 0.0});
  const VarianceSizes sizes = EstimateVariances(prior, parts, left);

  const double gain = sizes.log_likelihood - noise.log_likelihood;
  const double odds = kElse * std::exp(std::min(gain - kByChance, 100.0));
  Discrepancy found{odds / (1.0 + odds), MatrixXd::Zero(off.size(), off.size())};
  const Poses counted = Thinned(all, kMostCounted);
  const double each = static_cast<double>(all.size()) / static_cast<double>(counted.size());
  const MatrixXd moved = each * counted.all.by_parameters * covariance;
  for (std::size_t field = 0; field < fields.size(); ++field) {
    const double size = found.probability * sizes.of_parts[field + 1];
    found.covariance += size * CovarianceOfEstimates(fields[field], counted, moved);
  }
  return found;
}

}  // namespace abbe::fusion
