#include "fusion/machine_prior.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

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
// Knots of waves, m, and how many coefficients at most.
constexpr double kWaveKnots = 0.5e-3;
constexpr int kMostOfWave = 160;
constexpr int kPointsPerCoefficient = 6, kMostPoints = 200;
constexpr double kHardlyAllowed = 1e-7;  // least eigenvalue, of the largest variance

void RequireLengths(const ErrorPopulation& population) {
  if ((population.length > 0.0).all()) return;
  throw InputError(fmt::format("a correlation length of {} mm must be above 0",
                               1e3 * population.length.minCoeff()));
}

// exp(-(d / length)^2 / 2) between points.
MatrixXd Kernel(const VectorXd& x, double length) {
  MatrixXd K(x.size(), x.size());
  for (Index j = 0; j < x.size(); ++j) {
    K.col(j) = (-0.5 * ((x.array() - x[j]) / length).square()).exp();
  }
  return K;
}

// Any motion of an axis but its positioning.
constexpr int OtherThanPositioning(int axis) { return (axis + 1) % machine::kMotions; }

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
    double length = std::numeric_limits<double>::infinity();
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      const bool of_waves = motion == axis && population.wave[axis] > 0.0;  // has finer ones
      if (!of_waves) length = std::min(length, population.length(axis, motion));
    }
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

machine::VolumetricModel WithWaves(machine::VolumetricModel model,
                                   const std::array<bool, machine::kAxes>& axes) {
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    if (!axes[axis]) continue;
    const machine::Travel& travel = model.travels()[axis];
    const int size = model.Function(axis, axis).size();
    const int finer = std::min(
        kMostOfWave, static_cast<int>((travel.last - travel.first) / kWaveKnots) + kDegree);
    if (size == 0 || finer <= size) continue;
    model.SetForm(
        axis, axis,
        machine::MakeBSplineForm(BSplineBasis::Uniform(kDegree, travel.first, travel.last, finer)));
  }
  return model;
}

bool HoldsWaves(const machine::VolumetricModel& model, int axis) {
  return model.Function(axis, axis).size() >
         model.Function(axis, OtherThanPositioning(axis)).size();
}

MachinePrior::MachinePrior(const machine::Machine& machine, const machine::VolumetricModel& model,
                           const ErrorPopulation& population)
    : population_(population) {
  RequireLengths(population);
  const auto axes = std::make_shared<OfAxes>();
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    for (const bool positioning : {false, true}) {
      const int size = model.Function(axis, positioning ? axis : OtherThanPositioning(axis)).size();
      if (size == 0) continue;
      const machine::Travel& travel = machine.travels[axis];
      const auto basis = BSplineBasis::Uniform(kDegree, travel.first, travel.last, size);
      const Index points = std::min(kPointsPerCoefficient * size, std::max(kMostPoints, 2 * size));
      Projected& on = (*axes)[axis][positioning];
      on.x = VectorXd::LinSpaced(points, travel.first, travel.last);
      MatrixXd B(points, size);
      for (Index row = 0; row < points; ++row) B.row(row) = basis.Row(on.x[row]);
      const MatrixXd all = MatrixXd::Identity(points, points);
      on.onto = B.colPivHouseholderQr().solve(all);
      on.line = basis.LineCoefficients();
    }
  }
  axes_ = axes;
}

MachinePrior MachinePrior::With(const ErrorPopulation& population) const {
  RequireLengths(population);
  MachinePrior other = *this;
  other.population_ = population;
  return other;
}

MachinePrior::MachinePrior(const machine::Machine& machine, const machine::VolumetricModel& model,
                           double smoothness)
    : MachinePrior(machine, model, WithLength(PopulationOf(machine), smoothness)) {}

MachinePrior::Unit MachinePrior::UnitCovariance(int axis, int motion) const {
  return UnitOf(On(axis, motion), population_.length(axis, motion));
}

MachinePrior::Unit MachinePrior::UnitWave(int axis) const {
  return UnitOf(On(axis, axis), population_.wave_length[axis]);
}

MachinePrior::Unit MachinePrior::UnitOf(const Projected& on, double length) const {
  const MatrixXd K = Kernel(on.x, length);
  MatrixXd by_length = K;
  for (Index j = 0; j < K.cols(); ++j) {
    by_length.col(j).array() *= ((on.x.array() - on.x[j]) / length).square();
  }
  return {on.onto * K * on.onto.transpose(), on.onto * by_length * on.onto.transpose()};
}

MatrixXd MachinePrior::UnitSlope(int axis) const {
  const VectorXd& line = On(axis, axis).line;
  return line * line.transpose();
}

MatrixXd MachinePrior::PartOfWave(int axis) const {
  const double wave = population_.wave[axis];
  if (!(wave > 0.0)) return {};
  const MatrixXd W = Whitening(axis, axis);
  return wave * wave * UnitWave(axis).covariance * (W.transpose() * W);
}

MachinePrior::Spread MachinePrior::SpreadOf(int axis, int motion) const {
  const Projected& on = On(axis, motion);
  const auto squared = [](double sd) { return sd * sd; };
  MatrixXd K =
      squared(population_.deviation(axis, motion)) * Kernel(on.x, population_.length(axis, motion));
  const bool wave = motion == axis && population_.wave[axis] > 0.0;
  if (wave) K += squared(population_.wave[axis]) * Kernel(on.x, population_.wave_length[axis]);
  MatrixXd V = on.onto * K * on.onto.transpose();
  if (motion == axis) V += squared(population_.scale) * UnitSlope(axis);
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
    if (On(axis, axis).x.size() == 0) continue;
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      log -= SpreadOf(axis, motion).deviations.array().log().sum();
    }
  }
  return log;
}

}  // namespace abbe::fusion
