#include "standards/articulation.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "failure/failure.h"

namespace abbe::standards {
namespace {

using Points = std::vector<Eigen::Vector3d>;

// The sphere with all points on its surface and its centre in their plane or line.
std::optional<Sphere> SphereThrough(const Points& on) {
  const auto n = std::ssize(on) - 1;
  if (n == 0) return Sphere{on[0], 0.0};
  Eigen::MatrixXd edges(3, n);
  for (Eigen::Index i = 0; i < n; ++i) edges.col(i) = on[i + 1] - on[0];
  const Eigen::MatrixXd gram = 2.0 * edges.transpose() * edges;
  const Eigen::FullPivLU<Eigen::MatrixXd> lu(gram);
  if (!lu.isInvertible()) return std::nullopt;
  const Eigen::Vector3d to_centre = edges * lu.solve(edges.colwise().squaredNorm().transpose());
  return Sphere{on[0] + to_centre, to_centre.norm()};
}

bool Holds(const Sphere& sphere, const Points& points, double tolerance) {
  for (const Eigen::Vector3d& p : points) {
    if ((p - sphere.centre).norm() > sphere.radius + tolerance) return false;
  }
  return true;
}

// Smallest sphere of at most five points: all choices of one to four of them on the surface.
Sphere SmallSphere(const Points& points, double tolerance, Points& on_surface) {
  Sphere best{Eigen::Vector3d::Zero(), std::numeric_limits<double>::infinity()};
  for (unsigned choice = 1; choice < (1U << points.size()); ++choice) {
    Points on;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if ((choice >> i) & 1U) on.push_back(points[i]);
    }
    if (on.size() > 4) continue;
    const auto sphere = SphereThrough(on);
    if (sphere && sphere->radius < best.radius && Holds(*sphere, points, tolerance)) {
      best = *sphere;
      on_surface = on;
    }
  }
  return best;
}

}  // namespace

Sphere SmallestEnclosingSphere(const Eigen::Matrix3Xd& p) {
  if (p.cols() < 1 || !p.allFinite()) {
    throw InputError(fmt::format(
        "smallest sphere of {} points: give at least one, with finite numbers", p.cols()));
  }
  constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();
  constexpr int kMaxRounds = 10000;
  const Eigen::Vector3d origin =
      p.rowwise().mean();  // differences are small compared with positions
  const double tolerance = kRounding * (p.colwise() - origin).colwise().norm().maxCoeff() +
                           std::numeric_limits<double>::min();
  Points active{p.col(0) - origin};
  for (int round = 0; round < kMaxRounds; ++round) {
    Points on_surface;
    const Sphere sphere = SmallSphere(active, tolerance, on_surface);
    Eigen::Index far = 0;
    const double distance =
        ((p.colwise() - origin).colwise() - sphere.centre).colwise().norm().maxCoeff(&far);
    if (distance <= sphere.radius + tolerance) return {sphere.centre + origin, sphere.radius};
    active = on_surface;
    active.push_back(p.col(far) - origin);
  }
  throw NumericalError(
      fmt::format("smallest sphere of {} points: not found in {} rounds", p.cols(), kMaxRounds));
}

Articulation EvaluateArticulation(const Eigen::Matrix3Xd& p) {
  if (p.cols() < 2 || !p.allFinite()) {
    throw InputError(fmt::format(
        "articulation of {} poses: at least two are needed, each with finite numbers; the "
        "standard asks for five",
        p.cols()));
  }
  Articulation figures;
  figures.mean = p.rowwise().mean();
  figures.location = 2.0 * SmallestEnclosingSphere(p).radius;
  figures.distances = (p.colwise() - figures.mean).colwise().norm().transpose();
  figures.largest = figures.distances.maxCoeff();
  figures.range = figures.largest - figures.distances.minCoeff();
  figures.two_sigma = 2.0 * std::sqrt(figures.distances.squaredNorm() / (p.cols() - 1));
  return figures;
}

}  // namespace abbe::standards
