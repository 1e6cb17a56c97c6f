#include "relm/chain_inverse.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "failure/failure.h"

namespace abbe::relm {
namespace {

// Each angle in (-pi, pi].
Eigen::VectorXd Principal(Eigen::VectorXd angles) {
  for (double& angle : angles) {
    angle = std::remainder(angle, 2 * std::numbers::pi);
    if (angle <= -std::numbers::pi) angle = std::numbers::pi;
  }
  return angles;
}

double AngleBetween(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return Principal(a - b).cwiseAbs().maxCoeff();
}

}  // namespace

ChainInverse::ChainInverse(SerialChain chain, const InverseOptions& options)
    : chain_(std::move(chain)), options_(options), reach_(chain_.Reach()) {}

ChainInverse::Search ChainInverse::Run(const Eigen::Vector3d& p_BT,
                                       const Eigen::VectorXd& near) const {
  Eigen::VectorXd q = near;
  Eigen::Vector3d miss = p_BT - chain_.Tip(q);
  double damping = 1e-3 * reach_ * reach_;
  for (int step = 0; step < options_.max_steps; ++step) {
    if (!(miss.norm() > options_.tolerance * reach_)) break;
    const Eigen::Matrix3Xd J = chain_.JacobianTipAngles(q);
    const Eigen::Matrix3d normal = J * J.transpose() + damping * Eigen::Matrix3d::Identity();
    Eigen::VectorXd change = J.transpose() * normal.ldlt().solve(miss);
    const double largest = change.cwiseAbs().maxCoeff();
    if (largest > 0.5) change *= 0.5 / largest;  // rad: keeps to the branch of the start
    const Eigen::VectorXd next = q + change;
    const Eigen::Vector3d next_miss = p_BT - chain_.Tip(next);
    if (next_miss.norm() < miss.norm()) {
      q = next;
      miss = next_miss;
      damping *= 0.1;
    } else {
      damping = std::max(10 * damping, 1e-12 * reach_ * reach_);
      if (damping > 1e12 * reach_ * reach_) break;
    }
  }
  const Eigen::MatrixXd J = chain_.JacobianTipAngles(q);
  const auto singular_values = J.jacobiSvd().singularValues();
  const double smallest = J.cols() < 3 ? 0.0 : singular_values[2];
  return {q, miss.norm(), smallest};
}

std::optional<Eigen::VectorXd> ChainInverse::Find(const Eigen::Vector3d& p_BT,
                                                  const Eigen::VectorXd& near) const {
  if (near.size() != chain_.joints()) {
    throw InputError(fmt::format("linkage: {} start angles for a chain of {} joints", near.size(),
                                 chain_.joints()));
  }
  if (!p_BT.allFinite() || !near.allFinite()) return std::nullopt;
  Search search = Run(p_BT, near);
  // The remaining distance may be rounding: 16 eps of the reach is that of the forward sum.
  const double met = std::max(options_.tolerance, 16 * std::numeric_limits<double>::epsilon());
  if (!(search.miss <= met * reach_) || search.singular < options_.singular * reach_) {
    return std::nullopt;
  }
  return std::move(search.angles);
}

Eigen::VectorXd ChainInverse::Angles(const Eigen::Vector3d& p_BT,
                                     const Eigen::VectorXd& near) const {
  if (auto angles = Find(p_BT, near)) return *std::move(angles);
  if (!p_BT.allFinite() || !near.allFinite()) {
    throw NumericalError("linkage: the position or the start angles are not finite");
  }
  const Search search = Run(p_BT, near);
  if (search.miss > options_.tolerance * reach_) {
    throw NumericalError(fmt::format(
        "linkage: no angles put the ball at ({:.3f}, {:.3f}, {:.3f}) mm: {:.3g} mm are left after "
        "{} steps; it is out of reach or the start is on another branch",
        1e3 * p_BT.x(), 1e3 * p_BT.y(), 1e3 * p_BT.z(), 1e3 * search.miss, options_.max_steps));
  }
  throw NumericalError(fmt::format(
      "linkage: singular at ({:.3f}, {:.3f}, {:.3f}) mm: one direction moves the ball by only "
      "{:.3g} mm per rad; stay away from the edge of the workspace",
      1e3 * p_BT.x(), 1e3 * p_BT.y(), 1e3 * p_BT.z(), 1e3 * search.singular));
}

std::vector<Eigen::VectorXd> ChainInverse::Branches(const Eigen::Vector3d& p_BT) const {
  if (chain_.joints() != 3) {
    throw InputError(fmt::format(
        "linkage: branches are found for three joints, this chain has {}; give a start to Angles",
        chain_.joints()));
  }
  constexpr std::array kStarts{-2.7, -1.6, -0.5, 0.5, 1.6, 2.7};
  constexpr double kSame = 1e-6;  // rad: far above the tolerance, far below two branches
  std::vector<Eigen::VectorXd> found;
  for (const double q1 : kStarts) {
    for (const double q2 : kStarts) {
      for (const double q3 : kStarts) {
        const auto angles = Find(p_BT, Eigen::Vector3d(q1, q2, q3));
        if (!angles) continue;
        const Eigen::VectorXd principal = Principal(*angles);
        const auto same = [&](const auto& other) { return AngleBetween(principal, other) < kSame; };
        if (std::none_of(found.begin(), found.end(), same)) found.push_back(principal);
      }
    }
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  });
  return found;
}

}  // namespace abbe::relm
