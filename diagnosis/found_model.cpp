#include "diagnosis/found_model.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "simulation/causes/cause.h"
#include "standards/coverage.h"

namespace abbe::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using simulation::PreparedRun;

// From a pivot to the ball, m; the linkage stretched out.
double ReachBeyond(const std::string& pivot, const relm::SerialChain& chain) {
  double reach = 0.0;
  for (Index i = chain.joints(); i-- > 0;) {
    reach += chain.Link(i).norm();
    if (pivot == "pivot_" + std::to_string(i + 1)) return reach;
  }
  return reach;
}

// From the furthest end of the travels to the tool, m: no arm of an axis' angles is longer.
double LongestArm(const machine::Machine& mill) {
  double squares = 0.0;
  for (const auto& travel : mill.travels) squares += std::pow(travel.last - travel.first, 2);
  return std::sqrt(squares) + mill.reference.norm();
}

// Standard deviation of one row of a run, m: where the run sees a metre in a stage, its whitened
// rows are that many noises long. The worst of the probes, of the sensors, or of the axes.
std::optional<double> NoiseInSpace(const PreparedRun& run) {
  if (run.simulated.in_space) {
    const Index rows = run.simulated.residual->Rows();
    const Eigen::Matrix3Xd noise = run.simulated.in_space(VectorXd::Ones(rows));
    return std::sqrt(noise.squaredNorm() / noise.cols());
  }
  if (!run.simulated.response) return std::nullopt;
  const auto response = run.simulated.response->At(fusion::NominalValues(run.simulated.blocks));
  std::vector<Index> stages;
  for (Index i = 0; i < simulation::kEncoderStage - simulation::kReadingStage; ++i) {
    stages.push_back(simulation::kReadingStage + i);
  }
  if (!run.trace.head && !run.trace.rim) {
    stages = {simulation::Positioning(0), simulation::Positioning(1), simulation::Positioning(2)};
  }
  double noise = 0.0;
  for (const Index stage : stages) {
    const Index rows = run.trace.rows();
    const auto metre = simulation::InStage(run.trace, stage, Eigen::RowVectorXd::Ones(rows));
    const double seen = response->Columns({metre}).norm();
    if (seen > 0.0) noise = std::max(noise, std::sqrt(rows) / seen);
  }
  return noise > 0.0 ? std::optional(noise) : std::nullopt;
}

simulation::Unexplained UnexplainedOf(const Leftover& leftover, const Campaign& campaign) {
  return {leftover.object, leftover.variable, leftover.amplitude / leftover.unit.si,
          leftover.unit.name, InSpace(leftover, campaign)};
}

// What was learned on another machine, as large as it is on this one.
simulation::ModelledCause FoundOn(const Campaign& campaign, const Score& score) {
  for (const auto& carried : campaign.carried()) {
    if (&carried->cause() != score.candidate.cause) continue;
    simulation::LearnedTerm term = carried->term();
    term.coefficients = score.coefficients;
    term.covariance = score.covariance;
    term.u95_of_numbers.clear();  // they are those of the other machine
    return simulation::ModelledTerm(std::move(term));
  }
  return FoundCause(score);
}

simulation::ModelledCause ModelledOf(const Campaign& campaign, const Finding& finding) {
  simulation::ModelledCause cause = FoundOn(campaign, finding.score);
  cause.probability = finding.probability;
  for (const Rival& rival : finding.rivals) cause.rivals.push_back(rival.candidate.Name());
  return cause;
}

}  // namespace

simulation::ModelledCause FoundCause(const Score& score) {
  const auto [values, u] = KeysOf(score);
  const Eigen::Index count = score.coefficients.size();
  // A random field is known by its size, not by its values here.
  const Eigen::MatrixXd covariance = score.candidate.cause->IsRandomField()
                                         ? Eigen::MatrixXd{}
                                         : score.covariance.topLeftCorner(count, count).eval();
  return {score.candidate.cause, score.candidate.object, values, standards::kCoverage * u,
          covariance};
}

std::optional<double> InSpace(const Leftover& leftover, const Campaign& campaign) {
  if (leftover.variable == kScatter || leftover.variable == kMemory) {
    for (const PreparedRun& run : campaign.runs()) {
      if (run.simulated.name != leftover.object) continue;
      const auto noise = NoiseInSpace(run);
      return noise ? std::optional(leftover.amplitude * *noise) : std::nullopt;
    }
    return std::nullopt;
  }
  if (leftover.variable == kAtRest) return 0.0;  // noise, which the runs count as such
  const auto& linkage = campaign.instruments().linkage;
  if (leftover.unit.name == "urad" && leftover.object.starts_with("E")) {
    return leftover.amplitude * LongestArm(campaign.instruments().machine);
  }
  if (!leftover.object.starts_with("pivot_")) return leftover.amplitude;
  return linkage ? std::optional(leftover.amplitude * ReachBeyond(leftover.object, linkage->chain))
                 : std::nullopt;
}

simulation::ExtendedModel FoundModel(const Diagnosis& diagnosis, const Campaign& campaign,
                                     const HeldOutGain& gain) {
  simulation::ExtendedModel model;
  model.machine = campaign.instruments().machine.name;
  model.origin = campaign.origin();
  model.gain = {gain.rows, gain.before, gain.after, std::sqrt(diagnosis.chi_before),
                std::sqrt(diagnosis.chi_after)};
  model.verdict = Name(diagnosis.verdict);
  for (const Leftover& leftover : diagnosis.leftovers) {
    model.unexplained.push_back(UnexplainedOf(leftover, campaign));
  }
  for (const Finding& finding : diagnosis.findings) {
    if (IsModelled(finding)) model.causes.push_back(ModelledOf(campaign, finding));
    if (finding.next_run) model.next_runs.push_back(finding.next_run->text);
  }
  return model;
}

}  // namespace abbe::diagnosis
