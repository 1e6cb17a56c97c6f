#include "diagnosis/population_hypothesis.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "fusion/machine_prior.h"
#include "fusion/population_evidence.h"

namespace abbe::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using fusion::PopulationEvidence;

constexpr double kWorthASearch = 10.0;  // logarithm of the likelihood
constexpr double kAsBefore = 2.0;       // the same
constexpr int kSearches = 3, kFinerKnots = 3;

double LogDeterminant(const MatrixXd& positive) {
  return 2.0 * positive.llt().matrixLLT().diagonal().array().log().sum();
}

// By how much the likelihood may rise from where sizes and lengths are as in the file, by its slopes
// there.
double PossibleGain(const Fit& fit) {
  const Campaign& campaign = fit.campaign();
  const PopulationEvidence evidence(campaign.instruments().machine, campaign.model());
  const fusion::Quadratic machine = fit.OfMachine();
  const VectorXd stated = VectorXd::Zero(evidence.count());
  const auto local = evidence.SlopesAt(machine, stated, evidence.At(machine, stated));
  const Index free = evidence.of_functions();
  const VectorXd slope = local.gradient.head(free);
  return 0.5 *
         slope.dot(
             (local.fisher + evidence.precision()).topLeftCorner(free, free).ldlt().solve(slope));
}

machine::Population LinesOf(const machine::Population& stated,
                            const std::vector<fusion::Statement>& seen) {
  machine::Population lines = stated;
  lines.positioning = seen[fusion::kPositioning].seen;
  lines.straightness = seen[fusion::kStraightness].seen;
  lines.roll = seen[fusion::kRoll].seen;
  lines.pitch = seen[fusion::kPitch].seen;
  lines.yaw = seen[fusion::kYaw].seen;
  lines.smoothness = seen[fusion::kSmoothness].seen;
  return lines;
}

// Sizes and lengths of the errors as the runs show them.
class Population {
 public:
  // `stated`: the campaign as the machine file has it; from its simulation without causes.
  Population(const Campaign& stated, const Fit& base)
      : stated_(stated), machine_(stated.instruments().machine), knots_(fusion::KnotsOf(machine_)) {
    {
      const PopulationEvidence evidence(machine_, stated.model());
      theta_ = evidence.AtBestLength(base.OfMachine());
    }
    Follow(base);
    for (int i = 0; i < kFinerKnots; ++i) {
      const auto coarser = knots_;
      MakeCampaign();
      if (knots_ == coarser) break;
      Follow(Fit(*campaign_));
    }
  }

  // Those that a fit, with its causes, leaves; by how much the evidence rises.
  double Follow(const Fit& fit) {
    const PopulationEvidence evidence(machine_, fit.campaign().model());
    const fusion::Quadratic of_machine = fit.OfMachine();
    const double before = evidence.At(of_machine, theta_).log;
    const Index free = evidence.of_functions();
    const auto highest = evidence.Maximise(of_machine, theta_, free);
    theta_ = highest.theta;
    population_ = evidence.PopulationAt(theta_);
    statements_ = evidence.Statements(highest);
    const MatrixXd pi = evidence.precision().topLeftCorner(free, free);
    const MatrixXd known = pi + highest.local.fisher.topLeftCorner(free, free);
    const VectorXd at = theta_.head(free);
    prior_ = 0.5 * (LogDeterminant(pi) - LogDeterminant(known) - at.dot(pi * at));
    return highest.log - before;
  }

  void MakeCampaign() {
    knots_ = fusion::KnotsFor(machine_, population_, knots_);
    campaign_ = std::make_shared<const Campaign>(
        stated_.With(population_, knots_, LinesOf(machine_.population, statements_)));
  }

  // Of the simulation without causes with these sizes and lengths, against the stated ones.
  double LogOdds(const Fit& stated) const {
    return prior_ + Fit(*campaign_).log_likelihood() - stated.log_likelihood();
  }

  Answer Asked() const {
    Answer answer = Ask(campaign_, std::make_shared<Search>(*campaign_), prior_);
    answer.diagnosis.notes.push_back(Note());
    return answer;
  }

 private:
  std::string Note() const {
    std::string lines;
    for (const fusion::Statement& line : statements_) {
      if (!line.Refuted()) continue;
      lines += fmt::format("{}{} {:.2g} (machine file: {:.2g})", lines.empty() ? "" : ", ",
                           line.key, line.seen / line.unit, line.stated / line.unit);
    }
    if (lines.empty()) lines = "some are larger or smaller, smoother or rougher";
    return fmt::format(
        "the errors of the axes are not as the machine file says: {}; what the runs say counts",
        lines);
  }

  const Campaign& stated_;
  const machine::Machine& machine_;
  std::array<double, machine::kAxes> knots_;
  VectorXd theta_;
  double prior_ = 0.0;
  fusion::ErrorPopulation population_;
  std::vector<fusion::Statement> statements_;
  std::shared_ptr<const Campaign> campaign_;
};

// The answer that goes by what the runs show; `population`: of the simulation without causes.
Answer AsSeen(Population population) {
  Answer best = population.Asked();
  for (int search = 1;; ++search) {
    const bool settled = population.Follow(best.search->fit()) < kAsBefore;
    if (settled || search == kSearches) return best;
    population.MakeCampaign();
    Answer next = population.Asked();
    if (next.worth < best.worth) return best;
    best = std::move(next);
  }
}

bool IsUnexplained(const Answer& answer) {
  return answer.diagnosis.verdict == Verdict::kUnexplained;
}

Answer MoreProbable(Answer one, Answer other) {
  return other.worth > one.worth ? std::move(other) : std::move(one);
}

}  // namespace

Answer BesidePopulation(std::shared_ptr<const Campaign> campaign) {
  const auto as_stated = std::make_shared<Search>(*campaign);
  const Fit& base = as_stated->base();
  const bool has_axes = campaign->instruments().HasAxes();
  const bool may_differ = has_axes && PossibleGain(base) > kWorthASearch;
  if (may_differ) {
    Population seen(*campaign, base);
    if (seen.LogOdds(base) > as_stated->LogOddsOfFirst()) {
      Answer answer = AsSeen(std::move(seen));
      if (!IsUnexplained(answer)) return answer;
      return MoreProbable(Ask(campaign, as_stated, 0.0), std::move(answer));
    }
  }
  Answer answer = Ask(campaign, as_stated, 0.0);
  if (!has_axes || answer.diagnosis.verdict == Verdict::kClean) return answer;
  if (PossibleGain(answer.search->fit()) < kWorthASearch && !(may_differ && IsUnexplained(answer)))
    return answer;
  return MoreProbable(std::move(answer), AsSeen(Population(*campaign, base)));
}

}  // namespace abbe::diagnosis
