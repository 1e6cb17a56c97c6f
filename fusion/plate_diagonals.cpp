#include "fusion/plate_diagonals.h"

#include <cmath>
#include <limits>

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::Vector2d;
using Eigen::Vector3d;
using simulation::PlateSetUp;

constexpr double kAlong = 0.99;  // cosine

// Where a hole is in the plate: its certificate and the form that the fit found.
Vector2d PlaceInPlate(const PlateSetUp& setup, Index point, const estimation::Result& fit) {
  const int hole = setup.holes[static_cast<std::size_t>(point)];
  Vector2d place = setup.certificate.col(point);
  if (setup.u_form.maxCoeff() > 0.0) {
    place += fit.Block(simulation::HoleBlock(setup, hole)).Values();
  }
  return place;
}

struct Diagonal {
  double stretch, product, length;
};

// Between the outermost holes along u + v (sense 1) or u - v (-1).
Diagonal DiagonalOf(const PlateSetUp& setup, const Eigen::Matrix3Xd& places, double sense,
                    Index normal, const estimation::Result& fit) {
  const Eigen::RowVectorXd along = setup.certificate.row(0) + sense * setup.certificate.row(1);
  Index from = 0, to = 0;
  along.minCoeff(&from);
  along.maxCoeff(&to);
  const Vector3d apart = places.col(to) - places.col(from);
  const double true_length = (PlaceInPlate(setup, to, fit) - PlaceInPlate(setup, from, fit)).norm();
  const Vector3d d = apart.normalized();
  return {true_length / apart.norm() - 1.0, d[(normal + 1) % 3] * d[(normal + 2) % 3],
          apart.norm()};
}

}  // namespace

std::array<DiagonalSquareness, 3> SquarenessByDiagonals(const machine::VolumetricModel& model,
                                                        const Vector3d& reference,
                                                        const std::vector<PlateSetUp>& setups,
                                                        const estimation::Result& fit) {
  machine::VolumetricModel square = model;
  square.SetSquareness(Vector3d::Zero());
  std::array<DiagonalSquareness, 3> found{};
  for (const PlateSetUp& setup : setups) {
    const simulation::PointsOnMachine points(square, reference, setup.points);
    Index normal = 0;
    const Vector3d w = simulation::PlatePose(points, setup).R.col(2);
    if (w.cwiseAbs().maxCoeff(&normal) < kAlong) continue;
    const Eigen::Matrix3Xd places = points.Places(square.Parameters());
    const Diagonal one = DiagonalOf(setup, places, 1.0, normal, fit);
    const Diagonal other = DiagonalOf(setup, places, -1.0, normal, fit);
    const double products = one.product - other.product;
    auto& [value, u, count] = found[static_cast<std::size_t>(normal)];
    value += (normal == 1 ? 1.0 : -1.0) * (one.stretch - other.stretch) / products;
    // Two holes at the ends of each diagonal.
    u += 2.0 * std::pow(setup.u_probing / products, 2) *
         (std::pow(one.length, -2) + std::pow(other.length, -2));
    ++count;
  }
  for (auto& [value, u, count] : found) {
    value = count == 0 ? std::numeric_limits<double>::quiet_NaN() : value / count;
    u = count == 0 ? std::numeric_limits<double>::infinity() : std::sqrt(u) / count;
  }
  return found;
}

}  // namespace abbe::fusion
