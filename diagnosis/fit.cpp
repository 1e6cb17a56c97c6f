#include "diagnosis/fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "diagnosis/chord_solve.h"
#include "diagnosis/extended_run.h"
#include "estimation/in_parallel.h"
#include "failure/failure.h"
#include "fusion/machine_problem.h"
#include "simulation/causes/shaft.h"
#include "standards/coverage.h"
#include "standards/deviation_of_draws.h"

namespace abbe::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using estimation::Problem;
using simulation::SimulatedRun;

constexpr Index kPoseBlocks = 16;  // of consecutive poses, which share what no cause explains

// The values of a run's own blocks.
VectorXd ValuesIn(const estimation::Result& result, const SimulatedRun& run) {
  return fusion::ValuesFound(result, run.blocks);
}

// Where an earlier fit of the same blocks ended.
void StartFrom(const estimation::Result& before, std::vector<estimation::ParameterBlock>& blocks) {
  for (auto& block : blocks) {
    const auto found = std::find_if(before.blocks.begin(), before.blocks.end(),
                                    [&](const auto& other) { return other.name == block.name; });
    if (found == before.blocks.end()) continue;
    // A shape that has become free stands at the end.
    const std::size_t known = std::min(block.entries.size(), found->entries.size());
    for (std::size_t i = 0; i < known; ++i) block.entries[i].value = found->entries[i].value;
  }
}

// With the coefficients that another fit found.
void StartFromKnown(const std::vector<Candidate>& before, std::vector<Candidate>& causes) {
  for (Candidate& cause : causes) {
    const auto known = std::find_if(before.begin(), before.end(), [&](const Candidate& other) {
      return other.Name() == cause.Name();
    });
    if (known != before.end()) cause = *known;
  }
}

// The largest relative change of the coefficients.
double Moved(const std::vector<Candidate>& before, const std::vector<Candidate>& causes) {
  double most = 0.0;
  for (std::size_t i = 0; i < causes.size(); ++i) {
    const VectorXd& found = causes[i].coefficients;
    if (before[i].coefficients.size() != found.size()) return 1.0;
    most = std::max(most, (found - before[i].coefficients).norm() / found.norm());
  }
  return most;
}

Problem ProblemOf(const Campaign& campaign, const std::vector<SimulatedRun>& runs,
                  const std::vector<Candidate>& taken_in, const estimation::Result& start = {}) {
  machine::VolumetricModel model = campaign.model();
  if (!start.blocks.empty()) model.SetParameters(fusion::ValuesFound(start, model.Blocks()));
  Problem problem =
      fusion::MakeMachineProblem(campaign.instruments().machine, model, campaign.prior(), runs);
  // The machine's own blocks are made by the problem, not by a run.
  for (const Candidate& cause : taken_in) {
    if (!cause.cause->relaxes) continue;
    for (const std::string& name : cause.cause->relaxes(cause.object)) {
      if (!name.starts_with("squareness.")) continue;
      auto& entry = problem.Block(problem.Find("squareness"))[name.substr(11)];
      entry.prior_sd = std::hypot(entry.prior_sd, cause.cause->plausible[0]);
    }
  }
  return problem;
}

// What is left to the minimum is in the gradient, which the evidence takes into account: where a
// simulation that lacks something does not settle, near it is good enough. Standard uncertainties.
struct Near {
  double settled, tolerated;
};
constexpr Near kAsItIs{0.02, 1000.0}, kWithCauses{0.3, 1.0};

estimation::Result Solve(const Problem& problem, const Near& near, FitSums& sums) {
  constexpr int kFewPasses = 20;
  estimation::Linearization at;
  auto result = problem.Solve({.max_iterations = kFewPasses,
                               .settled = near.settled,
                               .tolerated = near.tolerated,
                               .jacobian_bytes = 0,
                               .weak_directions = false},
                              &at);
  sums = SumsOf(problem, at);
  return result;
}

// The excess of the noise of arms takes the redundancy of each source.
estimation::Result SolveWithCauses(const Campaign& campaign, const Problem& problem,
                                   FitSums& sums) {
  if (!campaign.EstimatesNoise()) {
    if (auto minimum = MinimumByChords(problem, kWithCauses.settled)) {
      sums = std::move(minimum->at);
      return std::move(minimum->result);
    }
  }
  return Solve(problem, kWithCauses, sums);
}

// As the last entry the logarithm of a shape that nothing else depends on.
void AddShape(MatrixXd& covariance, double variance) {
  const Index count = covariance.rows();
  covariance.conservativeResize(count + 1, count + 1);
  covariance.row(count).setZero();
  covariance.col(count).setZero();
  covariance(count, count) = variance;
}

// Takes out of a covariance what keeps the last entry, the logarithm of a shape, from going too far
// in one round: it is no knowledge. What is known no better without it stays bounded.
void FreeShape(MatrixXd& covariance) {
  constexpr double kMostOfIt = 0.99;
  const VectorXd with_shape = covariance.rightCols<1>();
  const double information = 1.0 / (kShapeFree * kShapeFree);
  const double share = std::min(information * with_shape[with_shape.size() - 1], kMostOfIt);
  covariance += information / (1.0 - share) * with_shape * with_shape.transpose();
}

// How many rows of all runs feel each of the draws of a random field.
Eigen::ArrayXi RowsFeeling(const Campaign& campaign, const Candidate& cause) {
  Eigen::ArrayXi rows = Eigen::ArrayXi::Zero(cause.cause->coefficients());
  for (const PreparedRun& run : campaign.runs()) {
    const auto columns = cause.cause->columns(run.trace, cause.object, cause.shape);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      for (const auto& [stage, values] : columns[i].stages()) {
        rows[static_cast<Index>(i)] += static_cast<int>((values.array() != 0.0).count());
      }
    }
  }
  return rows;
}

}  // namespace

Fit::Fit(const Campaign& campaign) : campaign_(campaign) {
  std::vector<SimulatedRun> runs;
  runs.reserve(campaign.runs().size());
  for (const PreparedRun& run : campaign.runs()) runs.push_back(run.simulated);
  const Problem problem = ProblemOf(campaign, runs, {});
  FitSums at;
  result_ = Solve(problem, kAsItIs, at);
  Linearize(problem, std::move(at));
}

Fit::Fit(const Fit& before, std::vector<Candidate> taken_in, int rounds)
    : campaign_(before.campaign_), taken_in_(std::move(taken_in)), result_(before.result_) {
  // The columns at the fit before, then at their own. What sensors make of a shaft is a product of
  // causes, and settles in steps.
  const bool of_shaft = !simulation::RimSensorsOf(campaign_.scene()).empty();
  constexpr int kRoundsOfShaft = 12;
  if (of_shaft) rounds = kRoundsOfShaft;
  if (of_shaft) StartFromKnown(before.taken_in_, taken_in_);
  constexpr double kShapeFound = 1e-3;  // relative
  for (int round = 1;; ++round) {
    std::vector<SimulatedRun> runs(campaign_.runs().size());
    estimation::InParallel(runs.size(), [&](std::size_t r) {
      const LinearRun& run = round == 1 ? before.runs_[r].at : runs_[r].at;
      runs[r] = Extend(campaign_.runs()[r], run, taken_in_);
      StartFrom(result_, runs[r].blocks);
    });
    const Problem problem = ProblemOf(campaign_, runs, taken_in_, result_);
    FitSums at;
    result_ = SolveWithCauses(campaign_, problem, at);
    const std::vector<Candidate> start = taken_in_;
    double moved = FollowShapes();
    if (of_shaft) moved = std::max(moved, Moved(start, taken_in_));
    if (round == rounds || (round > 1 && moved < kShapeFound)) {
      Linearize(problem, std::move(at));
      break;
    }
    TakeRuns(problem);
  }
}

// The largest relative change of the shapes.
double Fit::FollowShapes() {
  constexpr double kAtMost = 0.2, kDrawnFound = 0.05;
  double most = 0.0;
  for (Candidate& cause : taken_in_) {
    if (cause.cause->relaxes || cause.cause->IsBinary()) continue;
    const VectorXd found = result_.Block(BlockOf(cause)).Values();
    const VectorXd coefficients = found.head(cause.cause->coefficients());
    if (cause.cause->IsRandomField()) {
      constexpr double kLeast = 0.01;  // of what it was: a deviation of zero is no prior
      const double before = cause.shape[0];
      const Draws draws = DrawsOf(cause);
      if (draws.squares > 0.0) {
        cause.shape[0] = std::max(kLeast * before, std::sqrt(draws.squares / draws.seen));
      }
      // So few draws tell their deviation no better.
      const double moved = std::abs(1.0 - cause.shape[0] / before);
      if (moved > kDrawnFound) most = std::max(most, moved);
    } else if (cause.cause->FollowsItsSize()) {
      const Index fixed = std::max<Index>(cause.shape.size() - coefficients.size(), 0);
      const VectorXd before = cause.shape;
      cause.shape = simulation::AroundSizes(before.head(fixed), coefficients);
      most = std::max(most, before.size() < cause.shape.size()
                                ? 1.0
                                : (cause.shape - before).norm() / coefficients.norm());
    } else if (cause.HasFreeShape()) {
      const double step = std::clamp(found[found.size() - 1], -kAtMost, kAtMost);
      cause.shape *= std::exp(step);
      most = std::max(most, std::abs(step));
    } else if (cause.cause->shapes && !cause.cause->fixed_shapes) {
      most = 1.0;  // from now on its shape is free
    }
    cause.coefficients = coefficients;
  }
  return most;
}

// The priors are those of the fit: of eighty draws most are not seen at all, and a deviation changed
// since would count each of them a little. A draw that one row feels alone says how that run
// begins: where an axis moves from the first row on it counted as a stand without an offset.
Fit::Draws Fit::DrawsOf(const Candidate& cause) const {
  const auto& block = result_.Block(BlockOf(cause));
  const MatrixXd covariance = result_.Covariance(BlockOf(cause), BlockOf(cause));
  const Eigen::ArrayXi rows = RowsFeeling(campaign_, cause);
  Draws draws;
  for (Index i = 0; i < rows.size(); ++i) {
    if (rows[i] < 2) continue;
    const auto& draw = block.entries[static_cast<std::size_t>(i)];
    // What neither the data nor the priors determine has no variance.
    const double known = 1.0 - covariance(i, i) / (draw.prior_sd * draw.prior_sd);
    if (std::isfinite(known)) draws.seen += known;
    draws.squares += draw.value * draw.value;
  }
  draws.seen = std::max(draws.seen, 1.0);
  return draws;
}

void Fit::TakeRuns(const Problem& problem) {
  const VectorXd x = fusion::ValuesFound(result_, result_.blocks);
  const estimation::Layout layout(problem);
  std::vector<RunRows> runs(campaign_.runs().size());
  estimation::InParallel(runs.size(), [&](std::size_t r) {
    const PreparedRun& run = campaign_.runs()[r];
    estimation::RowEvaluator evaluator(problem, layout);
    const VectorXd& left = evaluator.Evaluate(problem.terms()[r], x, false)->r;
    runs[r] = {LinearAt(run, ValuesIn(result_, run.simulated), left, taken_in_), left, {}, {}};
  });
  runs_ = std::move(runs);
}

void Fit::Linearize(const Problem& problem, FitSums at) {
  TakeRuns(problem);
  const estimation::Layout layout(problem);
  const VectorXd x = fusion::ValuesFound(result_, result_.blocks);
  // Runs remember the derivatives of two places, and which of them are near enough changes with the
  // places that were asked for since. Directions that the runs hardly know bear no mixture of both.
  if (!campaign_.EstimatesNoise()) {
    if (auto known = KnownSumsAt(problem, x)) at = std::move(*known);
  }
  names_ = layout.names;
  gradient_ = std::move(at.gradient);
  data_information_ = std::move(at.data_information);
  data_gradient_ = std::move(at.data_gradient);
  prior_ = at.prior;
  scale_ = at.information.diagonal().cwiseSqrt().cwiseInverse();
  H_.compute(scale_.asDiagonal() * at.information * scale_.asDiagonal());
  // Normalising constants of the Gaussian priors; improper priors add the same constant to every
  // fit and are left out.
  const auto known = (prior_.array() > 0.0);
  const double priors =
      known.select(prior_.array(), 1.0).log().sum() + 2.0 * campaign_.prior().LogWhitening();
  const double curvature = 2.0 * MatrixXd(H_.matrixL()).diagonal().array().log().sum() -
                           2.0 * scale_.array().log().sum();
  log_likelihood_ = -at.cost + 0.5 * (priors - curvature);
  std::vector<double> left_out(runs_.size(), 0.0);
  estimation::InParallel(runs_.size(), [&](std::size_t r) {
    if (!runs_[r].at.response) return;
    RunDerivatives derivatives = DerivativesAt(problem, layout, problem.terms()[r], x);
    runs_[r].columns = std::move(derivatives.columns);
    const PreparedRun& run = campaign_.runs()[r];
    const MatrixXd& both = derivatives.both;
    if (run.EstimatesNoise()) {
      left_out[r] = run.excess * run.excess *
                    LeftOut(both.rightCols<1>(), runs_[r].columns, both.leftCols(both.cols() - 1));
    }
    runs_[r].back = runs_[r].at.response->BackToReadings(both);
  });
  left_out_ = std::accumulate(left_out.begin(), left_out.end(), 0.0);
}

// The residual r_B of rows B that are left out becomes (1 - J_B H^-1 J_B')^-1 r_B: Allen,
// Technometrics 16 (1974).
double Fit::LeftOut(const VectorXd& r, const std::vector<int>& columns, const MatrixXd& J) const {
  const Index poses = r.size() / 3;
  double sum = 0.0;
  for (Index block = 0; block < kPoseBlocks; ++block) {
    const Index first = 3 * (block * poses / kPoseBlocks),
                last = 3 * ((block + 1) * poses / kPoseBlocks);
    if (last == first) continue;
    MatrixXd A = MatrixXd::Zero(scale_.size(), last - first);
    A(columns, Eigen::all) = J.middleRows(first, last - first).transpose();
    A = scale_.asDiagonal() * A;
    const MatrixXd own = MatrixXd::Identity(A.cols(), A.cols()) - A.transpose() * H_.solve(A);
    sum += own.ldlt().solve(VectorXd(r.segment(first, last - first))).squaredNorm();
  }
  return sum;
}

double Fit::chi_square() const {
  double sum = 0.0;
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    sum += runs_[r].r.squaredNorm() * std::pow(campaign_.runs()[r].excess, 2);
  }
  return sum;
}

Index Fit::rows() const {
  Index rows = 0;
  for (const RunRows& run : runs_) rows += run.r.size();
  return rows;
}

Score Fit::ScoreOf(std::size_t taken_in) const {
  const Candidate& cause = taken_in_[taken_in];
  Score score{cause, {}, {}, 0.0, 0.0};
  if (cause.cause->IsBinary()) {
    score.coefficients = VectorXd::Ones(1);
    score.covariance = MatrixXd::Zero(1, 1);
    return score;
  }
  if (!cause.cause->relaxes) {
    score.coefficients = result_.Block(BlockOf(cause)).Values().head(cause.cause->coefficients());
    score.covariance = result_.Covariance(BlockOf(cause), BlockOf(cause));
    if (cause.HasFreeShape()) FreeShape(score.covariance);
    const std::string zero = "encoder_offset." + cause.object.name();
    if (cause.cause->phase_follows_encoder_zero && !ColumnsNamed(zero).empty()) {
      const Eigen::Vector2d turned(score.coefficients[1], -score.coefficients[0]);
      score.covariance.topLeftCorner<2, 2>() +=
          std::pow(cause.shape[0] * result_.Uncertainty(zero), 2) * turned * turned.transpose();
    }
    if (cause.cause->IsRandomField()) {
      const auto known = standards::DeviationOfDraws(DrawsOf(cause).seen);
      score.candidate.shape[0] *= known.median;
      AddShape(score.covariance, std::pow(known.u95 / standards::kCoverage, 2));
    } else if (cause.cause->shape_spread) {
      const double u = cause.cause->shape_spread(campaign_.scene(), cause.shape);
      if (u > 0.0) AddShape(score.covariance, std::pow(u / cause.shape[0], 2));
    }
    return score;
  }
  const std::vector<std::string> patterns = cause.cause->relaxes(cause.object);
  const Index count = patterns.size();
  score.coefficients = VectorXd::Zero(count);
  score.covariance = MatrixXd::Zero(count, count);
  for (Index i = 0; i < count; ++i) {
    for (const int column : ColumnsNamed(patterns[i])) {
      const std::string& name = names_[column];
      const std::size_t dot = name.rfind('.');
      const auto& entry = result_.Block(name.substr(0, dot))[name.substr(dot + 1)];
      score.coefficients[i] = entry.value - entry.nominal;
      score.covariance(i, i) = std::pow(result_.Uncertainty(name), 2);
    }
  }
  return score;
}

}  // namespace abbe::diagnosis
