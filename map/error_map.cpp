#include "map/error_map.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "failure/failure.h"

namespace abbe::map {
namespace {

// Relative asymmetry of a covariance that rounding explains; a larger one is a mistake.
constexpr double kAsymmetry = 1e-9;

void RefuseBadCovariance(const Eigen::MatrixXd& cov, const std::vector<std::string>& names) {
  const Eigen::Index count = names.size();
  if (cov.rows() != count || cov.cols() != count) {
    throw InputError(fmt::format("a covariance of {} x {} for a map of {} parameters", cov.rows(),
                                 cov.cols(), count));
  }
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::string& name = names[i];
    if (!cov.row(i).allFinite()) {
      throw InputError(fmt::format("the covariance of {} is not finite", name));
    }
    if (cov(i, i) < 0.0) throw InputError(fmt::format("the variance of {} is negative", name));
  }
  if ((cov - cov.transpose()).cwiseAbs().maxCoeff() > kAsymmetry * cov.cwiseAbs().maxCoeff()) {
    throw InputError("the covariance of the map is not symmetric");
  }
}

void RefuseBadState(const MapState& state, const ErrorMap& map) {
  std::vector<std::string> names = map.ParameterNames();
  names.insert(names.end(), state.names.begin(), state.names.end());
  if (!map.StatesUncertainty()) {
    throw InputError("the map of " + map.origin().machine + " has a state and no covariance");
  }
  if (state.values.size() != std::ssize(state.names) || !state.values.allFinite() ||
      !std::isfinite(state.time)) {
    throw InputError("the state of the map needs a finite value for each of its names");
  }
  for (const Warmth& each : state.sensors) {
    if (each.lag >= 0.0 && std::isfinite(each.lag + each.temperature + each.lagged)) continue;
    throw InputError("the state of the map holds no temperature of " + each.sensor);
  }
  RefuseBadCovariance(state.covariance, names);
}

}  // namespace

std::string ErrorName(int error) {
  if (error < 0 || error >= kErrors) {
    throw InputError(fmt::format("error {} does not exist: there are {}", error, kErrors));
  }
  const int motions = machine::kAxes * machine::kMotions;
  if (error < motions) {
    return machine::MotionName(error / machine::kMotions, error % machine::kMotions);
  }
  return std::array{"A0Z", "B0Z", "C0Y"}[error - motions];
}

int ErrorNamed(std::string_view name) {
  int error = kErrors - 1;
  while (error >= 0 && ErrorName(error) != name) --error;
  return error;
}

ErrorMap::ErrorMap(MapOrigin origin, machine::VolumetricModel model, Eigen::MatrixXd cov_pp,
                   std::optional<MapState> state)
    : origin_(std::move(origin)),
      model_(std::move(model)),
      cov_pp_(std::move(cov_pp)),
      state_(std::move(state)) {
  if (!model_.Parameters().allFinite() || !origin_.reference.allFinite() ||
      !origin_.tool.allFinite() || !std::isfinite(origin_.temperature)) {
    throw InputError("the map of " + origin_.machine + " holds a number that is not finite");
  }
  if (StatesUncertainty()) RefuseBadCovariance(cov_pp_, ParameterNames());
  if (state_) RefuseBadState(*state_, *this);
}

std::vector<std::string> ErrorMap::ParameterNames() const {
  std::vector<std::string> names;
  for (const auto& block : model_.Blocks()) {
    for (std::size_t i = 0; i < block.entries.size(); ++i) names.push_back(block.FullName(i));
  }
  return names;
}

std::string_view ErrorMap::Scale() const {
  return origin_.scale_is_calibrated ? "calibrated" : "prior only";
}

Eigen::Matrix3d ErrorMap::Covariance(const Eigen::Vector3d& position,
                                     const Eigen::Vector3d& p_TQ) const {
  if (!StatesUncertainty()) {
    throw InputError("the map of " + origin_.machine +
                     " has no uncertainty; fuse the runs again to get one");
  }
  const Eigen::Matrix3Xd J = model_.Linearize(position, p_TQ).J_error_parameters;
  std::vector<Eigen::Index> touched;  // of splines few at any place
  for (Eigen::Index i = 0; i < J.cols(); ++i) {
    if (!J.col(i).isZero(0.0)) touched.push_back(i);
  }
  const Eigen::Matrix3Xd some = J(Eigen::all, touched);
  const Eigen::MatrixXd of_touched = cov_pp_(touched, touched);
  return some * of_touched * some.transpose();
}

Eigen::Vector3d ErrorMap::StandardUncertainty(const Eigen::Vector3d& position,
                                              const Eigen::Vector3d& p_TQ) const {
  return Covariance(position, p_TQ).diagonal().cwiseMax(0.0).cwiseSqrt();
}

ErrorMap::Curve ErrorMap::CurveOf(int error, const Eigen::VectorXd& positions) const {
  constexpr int kAllMotions = machine::kAxes * machine::kMotions;
  const Eigen::Index n = model_.ParameterCount(), count = positions.size();
  Curve curve{Eigen::VectorXd(count), {}};
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(count, n);
  if (error >= kAllMotions) {
    curve.value.setConstant(model_.squareness()[error - kAllMotions]);
    J.col(n - kErrors + error).setOnes();
  } else {
    Eigen::Index first = 0;
    for (int e = 0; e < error; ++e) {
      first += model_.Function(e / machine::kMotions, e % machine::kMotions).size();
    }
    const auto& function = model_.Function(error / machine::kMotions, error % machine::kMotions);
    Eigen::VectorXd gradient(function.size());
    for (Eigen::Index i = 0; i < count; ++i) {
      curve.value[i] = function.Evaluate(positions[i], nullptr, gradient.data());
      J.row(i).segment(first, gradient.size()) = gradient.transpose();
    }
  }
  if (StatesUncertainty()) {
    curve.u = (J * cov_pp_).cwiseProduct(J).rowwise().sum().cwiseMax(0.0).cwiseSqrt();
  }
  return curve;
}

std::array<machine::Travel, 3> ErrorMap::Limits() const {
  return origin_.limits.value_or(machine::AroundTravels(model_.travels()));
}

}  // namespace abbe::map
