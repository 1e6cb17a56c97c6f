#include "fleet/population_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "failure/failure.h"
#include "failure/interruption.h"

namespace abbe::fleet {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using fusion::kLines;

constexpr double kSpread = 1.5;                      // s
constexpr double kHardlyTold = 0.9;                  // times s: the machines do not tell of a line
constexpr double kLongestStep = 0.7;                 // of phi
constexpr double kSettled = 1e-3;                    // of the logarithm to be gained
constexpr double kOwnSize = 0.4, kOwnLength = 0.25;  // deviations of delta
constexpr int kSteps = 100, kHalves = 12;

[[noreturn]] void RefuseUnsettled() {
  throw NumericalError(
      "the population of the fleet does not settle; look at the lines of [population], which "
      "should be right to a factor of five");
}

}  // namespace

PopulationFit::PopulationFit(const machine::Machine& machine, const machine::VolumetricModel& model,
                             const std::vector<Campaign>& campaigns)
    : model_(model),
      evidence_(machine, model),
      lines_(MatrixXd::Zero(evidence_.count(), kLines)),
      own_(VectorXd::Zero(evidence_.count())),
      phi_(VectorXd::Zero(kLines)) {
  if (campaigns.empty()) throw InputError("a fleet needs a campaign of a machine; give one");
  for (const Campaign& campaign : campaigns) {
    if (std::ranges::find(machines_, campaign.machine) != machines_.end()) continue;
    machines_.push_back(campaign.machine);
    seen_.push_back(campaign.seen);
  }
  for (Index i = 0; i < evidence_.count(); ++i) {
    lines_(i, evidence_.knobs()[i].line) = 1.0;
    if (evidence_.knobs()[i].axis >= 0) own_[i] = evidence_.IsLength(i) ? kOwnLength : kOwnSize;
  }
  Solve();
  const MatrixXd C = information_.inverse();
  for (Index line = 0; line < kLines; ++line) {
    const fusion::LineInFile& in_file = fusion::LinesInFile()[line];
    const double stated = machine.population.*in_file.value, u = std::sqrt(C(line, line));
    statements_.push_back(
        {.key = in_file.key,
         .unit = in_file.unit,
         .stated = stated,
         .seen = stated * std::exp(phi_[line]),
         .u_log = u < kHardlyTold * kSpread ? u : std::numeric_limits<double>::infinity()});
  }
}

PopulationFit::State PopulationFit::At(VectorXd phi, std::vector<VectorXd> eta) const {
  State at{.phi = std::move(phi), .eta = std::move(eta), .machines = {}};
  at.log = -0.5 * at.phi.squaredNorm() / (kSpread * kSpread);
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    MayBeInterrupted();
    const VectorXd theta = lines_ * at.phi + own_.cwiseProduct(at.eta[i]);
    const auto evidence = evidence_.At(seen_[i], theta);
    const double log = evidence.log + 0.5 * theta.dot(evidence_.precision() * theta);
    at.machines.push_back({log, evidence_.SlopesAt(seen_[i], theta, evidence)});
    at.log += log - 0.5 * at.eta[i].squaredNorm();
  }
  return at;
}

std::vector<PopulationFit::Part> PopulationFit::PartsAt(const State& at) const {
  std::vector<Part> parts;
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    const auto& [gradient, F] = at.machines[i].slopes;
    const MatrixXd DFX = own_.asDiagonal() * F * lines_;
    MatrixXd inner = own_.asDiagonal() * F * own_.asDiagonal();
    inner.diagonal().array() += 1.0;
    const Eigen::LLT<MatrixXd> factor(inner);
    const VectorXd eta_step = factor.solve(own_.cwiseProduct(gradient) - at.eta[i]);
    parts.push_back(
        {.score = lines_.transpose() * gradient - DFX.transpose() * eta_step,
         .information = lines_.transpose() * F * lines_ - DFX.transpose() * factor.solve(DFX),
         .eta_step = eta_step,
         .eta_slope = -factor.solve(DFX)});
  }
  return parts;
}

void PopulationFit::Solve() {
  State at = At(phi_, std::vector<VectorXd>(seen_.size(), VectorXd::Zero(own_.size())));
  for (int step = 0; step < kSteps; ++step) {
    parts_ = PartsAt(at);
    information_ = MatrixXd::Identity(kLines, kLines) / (kSpread * kSpread);
    VectorXd score = -at.phi / (kSpread * kSpread);
    for (const Part& part : parts_) {
      information_ += part.information;
      score += part.score;
    }
    const VectorXd phi_step = information_.ldlt().solve(score);
    if (!phi_step.allFinite()) RefuseUnsettled();
    double longest = phi_step.cwiseAbs().maxCoeff();
    std::vector<VectorXd> eta_step;
    for (const Part& part : parts_) {
      eta_step.emplace_back(part.eta_step + part.eta_slope * phi_step);
      longest = std::max(longest, own_.cwiseProduct(eta_step.back()).cwiseAbs().maxCoeff());
    }
    double share = std::min(1.0, kLongestStep / longest);
    const auto moved = [&] {
      std::vector<VectorXd> eta = at.eta;
      for (std::size_t i = 0; i < eta.size(); ++i) eta[i] += share * eta_step[i];
      return At(at.phi + share * phi_step, std::move(eta));
    };
    State next = moved();
    for (int halves = 0; halves < kHalves && !(next.log > at.log); ++halves) {
      share *= 0.5;
      next = moved();
    }
    const double gain = next.log - at.log;
    if (gain > 0.0) at = std::move(next);
    phi_ = at.phi;
    eta_ = at.eta;
    if (gain < kSettled) return;
  }
  RefuseUnsettled();
}

PopulationFit::Expected PopulationFit::ExpectedWithout(std::size_t machine) const {
  const MatrixXd C = (information_ - parts_[machine].information).inverse();
  const VectorXd phi = phi_ - C * parts_[machine].score;
  Expected expected{lines_ * phi, (lines_ * C * lines_.transpose()).diagonal()};
  for (Index i = 0; i < own_.size(); ++i) {
    const bool is_length = evidence_.IsLength(i);
    expected.spread[i] =
        std::hypot(std::sqrt(expected.spread[i]), is_length ? kOwnLength : kOwnSize);
    if (is_length) expected.theta[i] = (lines_ * phi_)[i] + own_[i] * eta_[machine][i];
  }
  return expected;
}

}  // namespace abbe::fleet
