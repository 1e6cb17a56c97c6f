#include "fusion/plate_diagonals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string_view>

#include "fusion/machine_problem.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using estimation::Result;
using simulation::PlateSetup;

constexpr double kAlong = 0.99;  // cosine: 8 degrees

// The place of a hole in the plate: its certificate and the estimated form.
Vector2d PlaceInPlate(const PlateSetup& setup, Index point, const Result& fit) {
  const int hole = setup.holes[point];
  Vector2d place = setup.certificate.col(point);
  if (setup.u_form.maxCoeff() > 0.0) {
    place += fit.Block(simulation::HoleBlock(setup, hole)).Values();
  }
  return place;
}

// The holes at its ends, and the effect of a squareness on it.
struct Diagonal {
  Index from = 0, to = 0;
  Vector2d direction;  // in the plate
  double true_length, stretch, product;
};

// Between the outermost holes along u + v (sense 1) or u - v (-1).
Diagonal DiagonalOf(const PlateSetup& setup, const Eigen::Matrix3Xd& places, double sense,
                    Index normal, const Result& fit) {
  Diagonal diagonal;
  const Eigen::RowVectorXd along = setup.certificate.row(0) + sense * setup.certificate.row(1);
  along.minCoeff(&diagonal.from);
  along.maxCoeff(&diagonal.to);
  const Vector3d apart = places.col(diagonal.to) - places.col(diagonal.from);
  const Vector2d in_plate =
      PlaceInPlate(setup, diagonal.to, fit) - PlaceInPlate(setup, diagonal.from, fit);
  const Vector3d d = apart.normalized();
  diagonal.direction = in_plate.normalized();
  diagonal.true_length = in_plate.norm();
  diagonal.stretch = diagonal.true_length / apart.norm() - 1.0;
  diagonal.product = d[(normal + 1) % 3] * d[(normal + 2) % 3];
  return diagonal;
}

// Derivatives with respect to the whitened residuals of the set-up: a hole that is read too far out
// reduces the stretch.
void AddWeights(const Diagonal& diagonal, double factor, const PlateSetup& setup, VectorXd& b) {
  const Vector2d weight = factor * setup.u_probing / diagonal.true_length * diagonal.direction;
  b.segment<2>(2 * diagonal.to) -= weight;
  b.segment<2>(2 * diagonal.from) += weight;
}

// The squareness by one set-up, and its derivatives with respect to the residuals.
struct OfSetup {
  Index normal;
  double value;
  VectorXd b;
};

std::optional<OfSetup> SquarenessOf(const machine::VolumetricModel& square,
                                    const Vector3d& reference, const PlateSetup& setup,
                                    const Result& fit) {
  const simulation::PointsOnMachine points(square, reference, setup.points);
  Index normal = 0;
  const Vector3d w = simulation::PlatePose(points, setup).R.col(2);
  if (w.cwiseAbs().maxCoeff(&normal) < kAlong) return std::nullopt;
  const Eigen::Matrix3Xd places = points.Places(square.Parameters());
  const Diagonal one = DiagonalOf(setup, places, 1.0, normal, fit);
  const Diagonal other = DiagonalOf(setup, places, -1.0, normal, fit);
  const double factor = (normal == 1 ? 1.0 : -1.0) / (one.product - other.product);
  OfSetup found{normal, factor * (one.stretch - other.stretch),
                VectorXd::Zero(2 * setup.points.count())};
  AddWeights(one, factor, setup, found.b);
  AddWeights(other, -factor, setup, found.b);
  return found;
}

// J' b of a set-up, in the free parameters of the fit.
VectorXd ByParameters(const simulation::SimulatedRun& run, const VectorXd& b, const Result& fit) {
  std::map<std::string_view, Index> columns;
  for (std::size_t c = 0; c < fit.names.size(); ++c) {
    columns.emplace(fit.names[c], c);
  }
  const VectorXd x = ValuesFound(fit, run.blocks);
  VectorXd values(b.size());
  estimation::RowMatrix J(b.size(), x.size());
  run.residual->Evaluate(x, values, &J);
  const VectorXd by_entries = J.transpose() * b;
  VectorXd by_columns = VectorXd::Zero(fit.covariance.cols());
  Index entry = 0;
  for (const auto& block : run.blocks) {
    for (std::size_t i = 0; i < block.entries.size(); ++i, ++entry) {
      const auto column = columns.find(block.FullName(i));
      if (column != columns.end()) by_columns[column->second] += by_entries[entry];
    }
  }
  return by_columns;
}

}  // namespace

std::array<DiagonalSquareness, 3> SquarenessByDiagonals(const FuseReport& fused,
                                                        const Vector3d& reference,
                                                        const std::vector<PlateSetup>& setups) {
  const machine::VolumetricModel& model = fused.map.model();
  const Result& fit = fused.fit;
  machine::VolumetricModel square = model;
  square.SetSquareness(Vector3d::Zero());
  std::array<DiagonalSquareness, 3> found{};
  std::array<double, 3> bb{};
  std::array<VectorXd, 3> Jb;
  Jb.fill(VectorXd::Zero(fit.covariance.cols()));
  for (std::size_t i = 0; i < setups.size(); ++i) {
    const PlateSetup& setup = setups[i];
    const auto here = SquarenessOf(square, reference, setup, fit);
    if (!here) continue;
    const std::size_t k = here->normal;
    found[k].value += here->value;
    ++found[k].setups;
    bb[k] += std::pow(fused.noise[i], 2) * here->b.squaredNorm();
    Jb[k] += ByParameters(simulation::SimulatePlate(model, reference, setup), here->b, fit);
  }
  for (std::size_t k = 0; k < found.size(); ++k) {
    auto& [value, u, count] = found[k];
    const double seen = bb[k] - Jb[k].dot(fit.covariance * Jb[k]);
    const int error = machine::kAxes * machine::kMotions + static_cast<int>(k);
    const double u_fit = fused.map.CurveOf(error, VectorXd::Zero(1)).u[0];
    value = count == 0 ? std::numeric_limits<double>::quiet_NaN() : value / count;
    u = count == 0 ? std::numeric_limits<double>::infinity()
                   : std::sqrt(u_fit * u_fit + std::max(seen, 0.0) / (count * count));
  }
  return found;
}

}  // namespace abbe::fusion
