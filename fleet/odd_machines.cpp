#include "fleet/odd_machines.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include "map/error_map.h"
#include "standards/chi_squared.h"

namespace abbe::fleet {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kTold = 1.0;    // of B: a direction of which the runs tell more than the prior
constexpr double kShown = 0.01;  // p of one case
constexpr double kFar = 8.0, kStep = 0.125;  // of ln f, in deviations

struct White {
  MatrixXd B;
  VectorXd w;
};

White Whitened(const fusion::Quadratic& seen, const MatrixXd& L) {
  return {L.transpose() * seen.information * L, L.transpose() * seen.vector};
}

White operator+(const White& one, const White& other) { return {one.B + other.B, one.w + other.w}; }

// With errors that have changed by `change` since.
White Changed(const White& white, double change) {
  MatrixXd loosened = change * change * white.B;
  loosened.diagonal().array() += 1.0;
  const Eigen::PartialPivLU<MatrixXd> factor(loosened);
  const MatrixXd B = factor.solve(white.B);
  return {0.5 * (B + B.transpose()), factor.solve(white.w)};
}

double LogZ(const White& white) {
  MatrixXd B = white.B;
  B.diagonal().array() += 1.0;
  const Eigen::LLT<MatrixXd> factor(B);
  const VectorXd half = factor.matrixL().solve(white.w);
  return 0.5 * half.squaredNorm() - factor.matrixLLT().diagonal().array().log().sum();
}

// What is known of some parameters, all others marginalised under the population.
White Alone(const White& white, const std::vector<Index>& of) {
  std::vector<Index> others;
  for (Index i = 0; i < white.w.size(); ++i) {
    if (!std::ranges::binary_search(of, i)) others.push_back(i);
  }
  MatrixXd inner = white.B(others, others);
  inner.diagonal().array() += 1.0;
  const Eigen::LLT<MatrixXd> factor(inner);
  const MatrixXd cross = white.B(others, of);
  const MatrixXd solved = factor.solve(cross);
  return {white.B(of, of) - cross.transpose() * solved,
          white.w(of) - solved.transpose() * white.w(others)};
}

// What a machine tells of one error, along the directions of which it tells.
struct Seen {
  VectorXd told, along;  // B_k, w_k

  double ChiSquare(double f) const {
    return (along.array().square() / ((f * told.array()).square() + told.array())).sum();
  }
};

Seen SeenOf(const White& alone) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(alone.B);
  const VectorXd along = eigen.eigenvectors().transpose() * alone.w;
  const Index first = (eigen.eigenvalues().array() < kTold).count();  // in ascending order
  const Index count = along.size() - first;
  return {eigen.eigenvalues().tail(count), along.tail(count)};
}

// In the mean over f, by the trapezoidal rule.
double PValue(const Seen& seen, double spread) {
  const auto freedom = static_cast<double>(seen.told.size());
  double sum = 0.0, weights = 0.0;
  for (double z = -kFar; z <= kFar; z += kStep) {
    const double weight = std::exp(-0.5 * z * z);
    sum += weight * standards::ChiSquaredExceeds(seen.ChiSquare(std::exp(spread * z)), freedom);
    weights += weight;
  }
  return sum / weights;
}

// One of the 21 errors: its parameters, and the knob of its size.
struct Error {
  std::vector<Index> parameters;
  Index knob;
};

// In the order of map::ErrorName.
std::vector<Error> Errors(const fusion::PopulationEvidence& evidence,
                          const machine::VolumetricModel& model) {
  std::vector<Error> errors;
  Index at = 0, knob = 0;
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      std::vector<Index> parameters(model.Function(axis, motion).size());
      std::iota(parameters.begin(), parameters.end(), at);
      at += std::ssize(parameters);
      errors.push_back({std::move(parameters), knob});
      if (!errors.back().parameters.empty()) knob += 2;
    }
  }
  for (Index k = 0; k < 3; ++k) errors.push_back({{evidence.squareness() + k}, knob});
  return errors;
}

}  // namespace

std::vector<OddError> OddErrors(const PopulationFit& fit) {
  const auto errors = Errors(fit.evidence(), fit.model());
  const double cases = static_cast<double>(errors.size() * fit.machines().size());
  std::vector<OddError> odd;
  for (std::size_t machine = 0; machine < fit.machines().size(); ++machine) {
    const auto [theta, spread] = fit.ExpectedWithout(machine);
    const White white = Whitened(fit.seen()[machine], fit.evidence().FactorAt(theta));
    for (std::size_t error = 0; error < errors.size(); ++error) {
      const auto& [parameters, knob] = errors[error];
      if (parameters.empty()) continue;
      const Seen seen = SeenOf(Alone(white, parameters));
      if (seen.told.size() == 0) continue;
      const double p = PValue(seen, spread[knob]);
      const double times = std::sqrt(seen.ChiSquare(1.0) / static_cast<double>(seen.told.size()));
      if (p > kShown || times < 1.0) continue;
      odd.push_back({.machine = fit.machines()[machine],
                     .error = map::ErrorName(static_cast<int>(error)),
                     .times = times,
                     .p_value = p,
                     .by_chance = p * cases});
    }
  }
  std::ranges::sort(odd, {}, &OddError::p_value);
  return odd;
}

std::vector<OddIdentity> OddIdentities(const PopulationFit& fit,
                                       const std::vector<Campaign>& campaigns,
                                       const IdentityOptions& options) {
  const MatrixXd L = fit.evidence().FactorAt(fit.theta());
  std::vector<White> each;
  for (const Campaign& campaign : campaigns) {
    each.push_back(Changed(Whitened(campaign.seen, L), options.change));
  }
  std::vector<double> alone;
  for (const White& one : each) alone.push_back(LogZ(one));
  const std::size_t count = campaigns.size();
  MatrixXd same = MatrixXd::Zero(count, count);  // log odds of two campaigns
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      same(i, j) = same(j, i) = LogZ(each[i] + each[j]) - alone[i] - alone[j];
    }
  }
  std::vector<OddIdentity> odd;
  for (std::size_t i = 0; i < count; ++i) {
    std::optional<double> said;  // none: its machine has no other campaign
    double best = 0.0;           // of a machine that the fleet does not have
    std::string fits;
    for (std::size_t j = 0; j < count; ++j) {
      if (i == j) continue;
      if (campaigns[i].machine == campaigns[j].machine) {
        said = std::max(said.value_or(same(i, j)), same(i, j));
      } else if (same(i, j) > best) {
        best = same(i, j);
        fits = campaigns[j].machine;
      }
    }
    const double log10 = (best - said.value_or(0.0)) / std::numbers::ln10;
    if (log10 < options.least) continue;
    odd.push_back({campaigns[i].name, campaigns[i].machine, fits, log10});
  }
  std::ranges::sort(odd, std::greater{}, &OddIdentity::log10_odds);
  return odd;
}

}  // namespace abbe::fleet
