#include "diagnosis/population_hypothesis.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
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
constexpr double kAsBefore = 5.0;       // the same
constexpr int kFinerKnots = 3;
constexpr int kRounds = 3;  // sizes that follow the others settle sooner

double LogDeterminant(const MatrixXd& positive) {
  return 2.0 * positive.llt().matrixLLT().diagonal().array().log().sum();
}

Answer MoreProbable(Answer one, Answer other) {
  return other.worth > one.worth ? std::move(other) : std::move(one);
}

// The most that the likelihood may rise from where sizes and lengths are as stated, by its slopes.
double PossibleGain(const Fit& fit) {
  const Campaign& campaign = fit.campaign();
  const PopulationEvidence evidence(campaign.instruments().machine, campaign.model());
  const fusion::Quadratic machine = fit.OfMachine();
  const VectorXd stated = VectorXd::Zero(evidence.count());
  const auto local = evidence.SlopesAt(machine, stated, evidence.At(machine, stated));
  const Index free = evidence.of_functions();
  const VectorXd slope = local.gradient.head(free);
  const MatrixXd curvature = (local.fisher + evidence.precision()).topLeftCorner(free, free);
  return 0.5 * slope.dot(curvature.ldlt().solve(slope));
}

// Sizes and lengths of the errors as the runs show them.
class Population {
 public:
  // `stated`: the campaign as the machine file has it; `fit`: of its runs, with the causes found.
  Population(const Campaign& stated, const Fit& fit)
      : stated_(stated), machine_(stated.instruments().machine), knots_(fusion::KnotsOf(machine_)) {
    const PopulationEvidence evidence(machine_, stated.model());
    theta_ = evidence.AtBestLength(fit.OfMachine());
    Follow(fit);
  }

  // These sizes and lengths against the stated ones, to first order at the last fit.
  double LogOdds() const { return gain_ + prior_; }

  // Those that a fit, with its causes, leaves; by how much the evidence rises.
  double Follow(const Fit& fit) {
    const PopulationEvidence evidence(machine_, fit.campaign().model());
    const fusion::Quadratic of_machine = fit.OfMachine();
    const double before = evidence.At(of_machine, theta_).log;
    const Index free = evidence.of_functions();
    const Index others = theta_.size() - free;
    const MatrixXd pi = evidence.precision();
    const MatrixXd of_others = pi.bottomRightCorner(others, others);
    const MatrixXd following = -of_others.ldlt().solve(MatrixXd(pi.bottomLeftCorner(others, free)));
    PopulationEvidence::Maximum highest;
    for (int round = 0; round < kRounds; ++round) {
      highest = evidence.Maximise(of_machine, theta_, free);
      theta_ = highest.theta;
      theta_.tail(others) = following * theta_.head(free);
    }
    population_ = evidence.PopulationAt(theta_);
    SetLines(evidence);
    const MatrixXd of_sizes =
        pi.topLeftCorner(free, free) + pi.topRightCorner(free, others) * following;
    const MatrixXd known = of_sizes + highest.local.fisher.topLeftCorner(free, free);
    const double now = evidence.At(of_machine, theta_).log,
                 of_theta = -0.5 * theta_.dot(pi * theta_);
    prior_ = of_theta + 0.5 * (LogDeterminant(of_sizes) - LogDeterminant(known));
    gain_ = now - of_theta - evidence.At(of_machine, VectorXd::Zero(theta_.size())).log;
    return now - before;
  }

  // On knots that are close enough, without causes; the campaign is made then.
  void FollowOnFinerKnots() {
    for (int i = 0; MakeCampaign() && i < kFinerKnots; ++i) Follow(Fit(*campaign_));
  }

  // False where the knots are as before.
  bool MakeCampaign() {
    const auto coarser = std::exchange(knots_, fusion::KnotsFor(machine_, population_, knots_));
    campaign_ = std::make_shared<const Campaign>(stated_.With(population_, knots_, lines_));
    return knots_ != coarser;
  }

  // With the positioning error of an axis as the others are, where it is rougher than these: what
  // repeats along the axis, as a screw does, may have made it so. False: it is not.
  bool AsTheOthers(int axis) {
    constexpr double kRougher = 1.5;
    const PopulationEvidence evidence(machine_, stated_.model());
    VectorXd theta = theta_;
    bool is_rougher = false;
    for (Index own = 0; own < evidence.of_functions(); ++own) {
      const fusion::Knob& knob = evidence.knobs()[own];
      if (knob.axis != axis || knob.motion != axis) continue;
      const auto others = MeanOf(knob.line, evidence, own);
      if (!others) continue;
      theta[own] = *others;
      if (evidence.IsLength(own)) is_rougher = theta[own] - theta_[own] > std::log(kRougher);
    }
    if (!is_rougher) return false;
    const MatrixXd& pi = evidence.precision();
    prior_ += 0.5 * (theta_.dot(pi * theta_) - theta.dot(pi * theta));
    theta_ = std::move(theta);
    population_ = evidence.PopulationAt(theta_);
    SetLines(evidence);
    return true;
  }

  Answer Asked() const {
    Answer answer = Ask(campaign_, std::make_shared<Search>(*campaign_), prior_);
    answer.diagnosis.notes.push_back(Note());
    return answer;
  }

 private:
  // What the lines of the machine file would be: of all errors that a line is for, the mean.
  void SetLines(const PopulationEvidence& evidence) {
    lines_ = machine_.population;
    for (int line = 0; line < fusion::kLines; ++line) {
      const auto mean = MeanOf(static_cast<fusion::Line>(line), evidence);
      if (mean) lines_.*fusion::LinesInFile()[line].value *= std::exp(*mean);
    }
  }

  // Over all functions that a line is for, but for one of theta; empty: there are none.
  std::optional<double> MeanOf(fusion::Line line, const PopulationEvidence& evidence,
                               Index but = -1) const {
    double sum = 0.0, count = 0.0;
    for (Index i = 0; i < evidence.of_functions(); ++i) {
      if (i == but || evidence.knobs()[i].line != line) continue;
      sum += theta_[i];
      count += 1.0;
    }
    return count > 0.0 ? std::optional(sum / count) : std::nullopt;
  }

  std::string Note() const {
    constexpr double kThird = 1.33;
    std::string lines;
    for (const fusion::LineInFile& line : fusion::LinesInFile()) {
      const double seen = lines_.*line.value, stated = machine_.population.*line.value;
      if (std::abs(std::log(seen / stated)) < std::log(kThird)) continue;
      lines += fmt::format("{}{} {:.2g} (machine file: {:.2g})", lines.empty() ? "" : ", ",
                           line.key, seen / line.unit, stated / line.unit);
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
  double gain_ = 0.0, prior_ = 0.0;
  fusion::ErrorPopulation population_;
  machine::Population lines_ = {};
  std::shared_ptr<const Campaign> campaign_;
};

// The answer that goes by a population, and by what it leaves; the campaign is made.
Answer Settled(Population& population) {
  Answer best = population.Asked();
  if (population.Follow(best.search->fit()) < kAsBefore) return best;
  population.MakeCampaign();
  return MoreProbable(std::move(best), population.Asked());
}

// The answer that goes by what the runs show; the campaign is made.
Answer AsSeen(Population population) {
  Answer best = Settled(population);
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    Population other = population;
    if (!other.AsTheOthers(axis)) continue;
    other.MakeCampaign();
    Answer answer = Settled(other);
    // What is in no catalogue follows any error too: it is no reason against a rough one.
    if (answer.diagnosis.verdict == Verdict::kUnexplained) continue;
    best = MoreProbable(std::move(best), std::move(answer));
  }
  return best;
}

}  // namespace

Answer BesidePopulation(std::shared_ptr<const Campaign> campaign) {
  const auto as_stated = std::make_shared<Search>(*campaign);
  const bool has_axes = campaign->instruments().HasAxes();
  if (has_axes && PossibleGain(as_stated->base()) > kWorthASearch) {
    Population seen(*campaign, as_stated->base());
    if (seen.LogOdds() > as_stated->LogOddsOfFirst()) {
      seen.FollowOnFinerKnots();
      Answer answer = AsSeen(std::move(seen));
      if (answer.diagnosis.verdict != Verdict::kUnexplained) return answer;
      // What is in no catalogue may look like rougher errors, until it is taken in.
      return MoreProbable(Ask(campaign, as_stated, 0.0), std::move(answer));
    }
  }
  Answer answer = Ask(campaign, as_stated, 0.0);
  const Fit& fit = answer.search->fit();
  if (!has_axes || answer.diagnosis.verdict == Verdict::kClean) return answer;
  if (PossibleGain(fit) < kWorthASearch) return answer;
  Population seen(*campaign, fit);
  if (seen.LogOdds() < kWorthASearch) return answer;
  seen.MakeCampaign();
  return MoreProbable(std::move(answer), AsSeen(std::move(seen)));
}

}  // namespace abbe::diagnosis
