#include "fusion/smooth_harmonics.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "machine/volumetric_jacobian.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;

constexpr Index kPlaces = 180;            // around the circle: no aliasing of these orders
constexpr double kLeastDeviation = 1e-9;  // m
constexpr double kTurn = 2.0 * std::numbers::pi;

double AngleOf(Index place) { return kTurn * place / kPlaces; }

double DeviationOf(const machine::Population& population, int axis, int motion) {
  if (motion < 3) return motion == axis ? population.positioning : population.straightness;
  if (motion - 3 == axis) return population.roll;
  const int pitch_about = axis == 1 ? 0 : 1;
  return motion - 3 == pitch_about ? population.pitch : population.yaw;
}

struct Circle {
  Eigen::Matrix3Xd positions;  // of the axes
  Eigen::MatrixXd J_radial;    // with respect to the 18 error motions, one row a place
};

Circle CircleOf(const machine::Machine& machine, const paths::CircleRun& run) {
  Circle circle{Eigen::Matrix3Xd(3, kPlaces),
                Eigen::MatrixXd(kPlaces, machine::kAxes * machine::kMotions)};
  for (Index i = 0; i < kPlaces; ++i) {
    const double t = AngleOf(i);
    const Eigen::Vector3d out = std::cos(t) * run.plane.first + std::sin(t) * run.plane.second;
    circle.positions.col(i) = run.centre + run.radius * out;
    const Eigen::Vector3d out_W = machine.chain.ToolSenses().cwiseProduct(out);
    const auto J = machine::VolumetricErrorAndJacobian(machine.chain, circle.positions.col(i),
                                                       -machine.reference, {});
    circle.J_radial.row(i) = out_W.transpose() * J.J_error_motions;
  }
  return circle;
}

Eigen::MatrixXd RadialCovariance(const machine::Machine& machine, const Circle& circle) {
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(kPlaces, kPlaces);
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    const Eigen::ArrayXd at =
        circle.positions.row(axis).transpose().array() / machine.population.smoothness;
    const Eigen::ArrayXXd apart = at.replicate(1, kPlaces) - at.transpose().replicate(kPlaces, 1);
    const Eigen::MatrixXd correlation = (-0.5 * apart.square()).exp().matrix();
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      const Eigen::VectorXd J = DeviationOf(machine.population, axis, motion) *
                                circle.J_radial.col(machine::kMotions * axis + motion);
      covariance += J.asDiagonal() * correlation * J.asDiagonal();
    }
  }
  return covariance;
}

}  // namespace

std::vector<double> SmoothHarmonics(const machine::Machine& machine, const paths::CircleRun& run) {
  const Eigen::MatrixXd covariance = RadialCovariance(machine, CircleOf(machine, run));
  std::vector<double> deviations;
  std::size_t last = 0;
  for (int order = kFirstHarmonic; order <= kLastHarmonic; ++order) {
    Eigen::MatrixX2d waves(kPlaces, 2);
    for (Index i = 0; i < kPlaces; ++i) {
      waves.row(i) << std::cos(order * AngleOf(i)), std::sin(order * AngleOf(i));
    }
    waves *= 2.0 / kPlaces;
    const double variance = (waves.transpose() * covariance * waves).trace() / 2.0;
    deviations.push_back(std::max(kLeastDeviation, std::sqrt(std::max(0.0, variance))));
    if (deviations.back() > kLeastDeviation) last = deviations.size();
  }
  deviations.resize(last);
  return deviations;
}

}  // namespace abbe::fusion
