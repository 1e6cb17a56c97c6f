#include "fusion/machine_prior.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "failure/failure.h"
#include "geometry/b_spline.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using geometry::BSplineBasis;

constexpr int kDegree = 5;
constexpr double kKnotsPerLength = 2.0;
constexpr int kPointsPerCoefficient = 6;
constexpr double kHardlyAllowed = 1e-7;  // least eigenvalue, of the largest variance

BSplineBasis BasisOf(const machine::Travel& travel, Index size) {
  return BSplineBasis::Uniform(kDegree, travel.first, travel.last, static_cast<int>(size));
}

}  // namespace

machine::VolumetricModel UnknownMachine(const machine::Machine& machine) {
  machine::VolumetricModel model(machine.chain, machine.travels);
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    const machine::Travel& travel = machine.travels[static_cast<std::size_t>(axis)];
    if (!(travel.last > travel.first)) continue;  // the machine has no such axis
    const double spans =
        std::ceil(kKnotsPerLength * (travel.last - travel.first) / machine.population.smoothness);
    const auto form = machine::MakeBSplineForm(
        BasisOf(travel, static_cast<Index>(std::max(1.0, spans)) + kDegree));
    for (int motion = 0; motion < machine::kMotions; ++motion) model.SetForm(axis, motion, form);
  }
  return model;
}

MachinePrior::MachinePrior(const machine::Machine& machine, const machine::VolumetricModel& model,
                           double smoothness)
    : machine_(machine), sizes_{}, smoothness_(smoothness) {
  if (!(smoothness > 0.0)) {
    throw InputError(
        fmt::format("a correlation length of {} mm must be above 0", 1e3 * smoothness));
  }
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      sizes_[axis][motion] = model.Function(axis, motion).size();
    }
  }
}

MatrixXd MachinePrior::Covariance(int axis, int motion) const {
  const machine::Travel& travel = machine_.travels[static_cast<std::size_t>(axis)];
  const BSplineBasis basis = BasisOf(travel, sizes_[axis][motion]);
  const Index points = kPointsPerCoefficient * sizes_[axis][motion];
  const VectorXd x = VectorXd::LinSpaced(points, travel.first, travel.last);
  MatrixXd B(points, basis.size());
  for (Index i = 0; i < points; ++i) B.row(i) = basis.Row(x[i]);
  const double sd = machine::PopulationDeviation(machine_.population, axis, motion);
  MatrixXd K(points, points);
  for (Index j = 0; j < points; ++j) {
    K.col(j) = sd * sd * (-0.5 * ((x.array() - x[j]) / smoothness_).square()).exp();
  }
  const MatrixXd P = B.colPivHouseholderQr().solve(MatrixXd::Identity(points, points));
  MatrixXd V = P * K * P.transpose();
  if (motion == axis) {
    const VectorXd line = basis.LineCoefficients();
    V += machine_.population.scale * machine_.population.scale * line * line.transpose();
  }
  return V;
}

MatrixXd MachinePrior::Whitening(int axis, int motion) const {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(Covariance(axis, motion));
  const double least = kHardlyAllowed * eigen.eigenvalues().maxCoeff();
  const VectorXd deviations = eigen.eigenvalues().cwiseMax(least).cwiseSqrt();
  return deviations.cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace abbe::fusion
