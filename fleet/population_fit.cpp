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
constexpr double kSettled = 0.1;                     // of phi, in standard deviations
constexpr double kOwnSize = 0.4, kOwnLength = 0.25;  // deviations of delta
constexpr int kSteps = 60, kHalves = 5;

}  // namespace

PopulationFit::PopulationFit(const machine::Machine& machine, const machine::VolumetricModel& model,
                             const std::vector<Campaign>& campaigns)
    : model_(model),
      evidence_(machine, model),
      lines_(MatrixXd::Zero(evidence_.count(), kLines)),
      phi_(VectorXd::Zero(kLines)) {
  if (campaigns.empty()) throw InputError("a fleet needs a campaign of a machine; give one");
  for (const Campaign& campaign : campaigns) {
    if (std::ranges::find(machines_, campaign.machine) != machines_.end()) continue;
    machines_.push_back(campaign.machine);
    seen_.push_back(campaign.seen);
  }
  for (Index i = 0; i < evidence_.count(); ++i) lines_(i, evidence_.knobs()[i].line) = 1.0;
  Solve();
  const MatrixXd C = at_.information.inverse();
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

// Of the score from zero, in variances.
double PopulationFit::OffOf(const Sums& at) {
  return at.score.dot(at.information.ldlt().solve(at.score));
}

PopulationFit::Sums PopulationFit::SumsAt(const VectorXd& phi) const {
  const VectorXd theta = lines_ * phi;
  VectorXd own(theta.size());  // variances of delta
  for (Index i = 0; i < own.size(); ++i) {
    const bool of_function = evidence_.knobs()[i].axis >= 0;
    own[i] = of_function ? std::pow(evidence_.IsLength(i) ? kOwnLength : kOwnSize, 2) : 0.0;
  }
  Sums sums{.score = -phi / (kSpread * kSpread),
            .information = MatrixXd::Identity(kLines, kLines) / (kSpread * kSpread),
            .scores = {},
            .informations = {}};
  for (const auto& machine : seen_) {
    MayBeInterrupted();
    const auto slopes = evidence_.SlopesAt(machine, theta, evidence_.At(machine, theta));
    const VectorXd weight = (1.0 + slopes.fisher.diagonal().array() * own.array()).inverse();
    const VectorXd root = weight.cwiseSqrt();
    sums.scores.emplace_back(lines_.transpose() * weight.cwiseProduct(slopes.gradient));
    sums.informations.emplace_back(lines_.transpose() * root.asDiagonal() * slopes.fisher *
                                   root.asDiagonal() * lines_);
    sums.score += sums.scores.back();
    sums.information += sums.informations.back();
  }
  return sums;
}

void PopulationFit::Solve() {
  at_ = SumsAt(phi_);
  for (int step = 0; step < kSteps; ++step) {
    VectorXd way = at_.information.ldlt().solve(at_.score);
    const double off = way.dot(at_.score);
    if (off < kSettled * kSettled) return;
    way *= std::min(1.0, kLongestStep / way.cwiseAbs().maxCoeff());
    Sums next = SumsAt(phi_ + way);
    for (int halves = 0; halves < kHalves && OffOf(next) > off; ++halves) {
      way *= 0.5;
      next = SumsAt(phi_ + way);
    }
    phi_ += way;
    at_ = std::move(next);
  }
  throw NumericalError(
      "the population of the fleet does not settle; look at the lines of [population], which "
      "should be right to a factor of five");
}

VectorXd PopulationFit::ThetaWithout(std::size_t machine) const {
  const MatrixXd others = at_.information - at_.informations[machine];
  return lines_ * (phi_ - others.ldlt().solve(at_.scores[machine]));
}

}  // namespace abbe::fleet
