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
// Knots may be so many correlation lengths apart before finer ones are made, and are then made so.
constexpr double kCoarse = 0.6, kFine = 0.4;
constexpr double kFinest = 1.0 / 12.0;  // of the correlation length of the machine file
constexpr int kPointsPerCoefficient = 6;
constexpr double kHardlyAllowed = 1e-7;  // least eigenvalue, of the largest variance

ErrorPopulation WithLength(ErrorPopulation population, double smoothness) {
  population.length = smoothness;
  return population;
}

}  // namespace

ErrorPopulation PopulationOf(const machine::Machine& machine) {
  ErrorPopulation population{{},
                             ErrorPopulation::OfFunctions::Constant(machine.population.smoothness),
                             machine.population.squareness,
                             machine.population.scale};
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      population.deviation(axis, motion) =
          machine::PopulationDeviation(machine.population, axis, motion);
    }
  }
  return population;
}

std::array<double, machine::kAxes> KnotsOf(const machine::Machine& machine) {
  const double knots = machine.population.smoothness / kKnotsPerLength;
  return {knots, knots, knots};
}

std::array<double, machine::kAxes> KnotsFor(const machine::Machine& machine,
                                            const ErrorPopulation& population,
                                            const std::array<double, machine::kAxes>& knots) {
  const double least = kFinest * machine.population.smoothness;
  std::array<double, machine::kAxes> finer = knots;
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    const double length = population.length.row(axis).minCoeff();
    if (!(kCoarse * length < knots[axis]) || knots[axis] <= least) continue;
    finer[axis] = std::max(least, kFine * length);
  }
  return finer;
}

machine::VolumetricModel UnknownMachine(const machine::Machine& machine) {
  return UnknownMachine(machine, KnotsOf(machine));
}

machine::VolumetricModel UnknownMachine(const machine::Machine& machine,
                                        const std::array<double, machine::kAxes>& knots) {
  machine::VolumetricModel model(machine.chain, machine.travels);
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    const machine::Travel& travel = machine.travels[axis];
    if (!(travel.last > travel.first)) continue;  // the machine has no such axis
    const double spans = std::ceil((travel.last - travel.first) / knots[axis]);
    const auto form = machine::MakeBSplineForm(BSplineBasis::Uniform(
        kDegree, travel.first, travel.last, static_cast<int>(std::max(1.0, spans)) + kDegree));
    for (int motion = 0; motion < machine::kMotions; ++motion) model.SetForm(axis, motion, form);
  }
  return model;
}

MachinePrior::MachinePrior(const machine::Machine& machine, const machine::VolumetricModel& model,
                           const ErrorPopulation& population)
    : population_(population) {
  if (!(population.length > 0.0).all()) {
    throw InputError(fmt::format("a correlation length of {} mm must be above 0",
                                 1e3 * population.length.minCoeff()));
  }
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    const int size = model.Function(axis, 0).size();
    if (size == 0) continue;
    const machine::Travel& travel = machine.travels[axis];
    const auto basis = BSplineBasis::Uniform(kDegree, travel.first, travel.last, size);
    const Index points = Index{kPointsPerCoefficient} * size;
    Projected& on = axes_[axis];
    on.x = VectorXd::LinSpaced(points, travel.first, travel.last);
    MatrixXd B(points, size);
    for (Index row = 0; row < points; ++row) B.row(row) = basis.Row(on.x[row]);
    const MatrixXd all = MatrixXd::Identity(points, points);
    on.onto = B.colPivHouseholderQr().solve(all);
    on.line = basis.LineCoefficients();
  }
}

MachinePrior::MachinePrior(const machine::Machine& machine, const machine::VolumetricModel& model,
                           double smoothness)
    : MachinePrior(machine, model, WithLength(PopulationOf(machine), smoothness)) {}

MachinePrior::Unit MachinePrior::UnitCovariance(int axis, int motion) const {
  const Projected& on = axes_[axis];
  const Index points = on.x.size();
  const double length = population_.length(axis, motion);
  MatrixXd K(points, points), by_length(points, points);
  for (Index j = 0; j < points; ++j) {
    const Eigen::ArrayXd square = ((on.x.array() - on.x[j]) / length).square();
    K.col(j) = (-0.5 * square).exp();
    by_length.col(j) = K.col(j).array() * square;
  }
  return {on.onto * K * on.onto.transpose(), on.onto * by_length * on.onto.transpose()};
}

MatrixXd MachinePrior::UnitSlope(int axis) const {
  const VectorXd& line = axes_[axis].line;
  return line * line.transpose();
}

MachinePrior::Spread MachinePrior::SpreadOf(int axis, int motion) const {
  MatrixXd V =
      std::pow(population_.deviation(axis, motion), 2) * UnitCovariance(axis, motion).covariance;
  if (motion == axis) V += population_.scale * population_.scale * UnitSlope(axis);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(V);
  const double least = kHardlyAllowed * eigen.eigenvalues().maxCoeff();
  return {eigen.eigenvectors(), eigen.eigenvalues().cwiseMax(least).cwiseSqrt()};
}

MatrixXd MachinePrior::Whitening(int axis, int motion) const {
  const Spread spread = SpreadOf(axis, motion);
  return spread.deviations.cwiseInverse().asDiagonal() * spread.axes.transpose();
}

double MachinePrior::LogWhitening() const {
  double log = 0.0;
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    if (axes_[axis].x.size() == 0) continue;
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      log -= SpreadOf(axis, motion).deviations.array().log().sum();
    }
  }
  return log;
}

}  // namespace abbe::fusion
