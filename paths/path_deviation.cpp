#include "paths/path_deviation.h"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "failure/failure.h"

namespace abbe::paths {
namespace {

constexpr double kSamePoint = 1e-9;  // m: nominal points nearer than this are one
// Pieces before and behind the last nearest one that are searched first. The whole path is searched
// when the nearest of them is the first or the last, or is farther off than the limits below.
constexpr Eigen::Index kNeighbours = 20;
constexpr double kFarther = 1.5;     // times the last distance
constexpr double kFartherBy = 1e-6;  // m, in addition

struct Chain {
  Eigen::Matrix3Xd points;
  Eigen::VectorXd along;  // arc length at each point
};

Chain Pieces(const Eigen::Matrix3Xd& points, const std::string& recording) {
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    if (kept.empty() || (points.col(i) - points.col(kept.back())).norm() > kSamePoint) {
      kept.push_back(i);
    }
  }
  if (kept.size() < 2) {
    throw InputError(
        fmt::format("{}: the nominal path has {} points: a path needs two at least that differ",
                    recording, kept.size()));
  }
  Chain chain{Eigen::Matrix3Xd(3, kept.size()), Eigen::VectorXd::Zero(kept.size())};
  for (Eigen::Index i = 0; i < chain.points.cols(); ++i) {
    chain.points.col(i) = points.col(kept[i]);
    if (i > 0) {
      chain.along[i] = chain.along[i - 1] + (chain.points.col(i) - chain.points.col(i - 1)).norm();
    }
  }
  return chain;
}

struct Nearest {
  Eigen::Index piece = 0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  double along = 0.0;
  double distance = std::numeric_limits<double>::infinity();
};

Nearest NearestOn(const Chain& chain, const Eigen::Vector3d& p, Eigen::Index first,
                  Eigen::Index last) {
  Nearest best;
  for (Eigen::Index i = first; i < last; ++i) {
    const Eigen::Vector3d start = chain.points.col(i), piece = chain.points.col(i + 1) - start;
    const double part = std::clamp((p - start).dot(piece) / piece.squaredNorm(), 0.0, 1.0);
    const Eigen::Vector3d point = start + part * piece;
    const double distance = (p - point).norm();
    if (distance < best.distance) best = {i, point, chain.along[i] + part * piece.norm(), distance};
  }
  return best;
}

}  // namespace

geometry::Transform<double> RigidMotion(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to) {
  const Eigen::Vector3d a = from.rowwise().mean(), b = to.rowwise().mean();
  const Eigen::Matrix3d S = (to.colwise() - b) * (from.colwise() - a).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(S, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sign(1.0, 1.0, 1.0);
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0) sign.z() = -1.0;
  geometry::Transform<double> X;
  X.R = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  X.p = b - X.R * a;
  return X;
}

PathDeviation DeviationFrom(const MeasuredPath& path, const DeviationOptions& options) {
  const Chain chain =
      Pieces(options.nominal.cols() > 0 ? options.nominal : path.commanded, path.recording);
  PathDeviation result;
  result.measured = path.measured;
  if (options.align) {
    const auto X = RigidMotion(path.measured, path.commanded);
    result.measured = (X.R * path.measured).colwise() + X.p;
  }
  result.length = chain.along[chain.along.size() - 1];
  result.deviation.resize(3, path.poses());
  result.along.resize(path.poses());
  Nearest last;
  for (Eigen::Index i = 0; i < path.poses(); ++i) {
    const Eigen::Vector3d p = result.measured.col(i);
    const Eigen::Index first = std::max<Eigen::Index>(0, last.piece - kNeighbours);
    const Eigen::Index end = std::min(chain.points.cols() - 1, last.piece + kNeighbours + 1);
    Nearest nearest = NearestOn(chain, p, first, end);
    if (i == 0 || nearest.piece == first || nearest.piece == end - 1 ||
        nearest.distance > kFarther * last.distance + kFartherBy) {
      nearest = NearestOn(chain, p, 0, chain.points.cols() - 1);
    }
    result.deviation.col(i) = p - nearest.point;
    result.along[i] = nearest.along;
    last = nearest;
  }
  result.largest = result.deviation.colwise().norm().maxCoeff();
  result.rms = std::sqrt(result.deviation.squaredNorm() / path.poses());
  return result;
}

}  // namespace abbe::paths
