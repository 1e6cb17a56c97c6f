#include "diagnosis/plan.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "diagnosis/diagnose.h"
#include "diagnosis/drawn_machine.h"
#include "diagnosis/linear_runs.h"
#include "diagnosis/standing_pairs.h"
#include "estimation/in_parallel.h"

namespace abbe::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kAtOnce = 128;  // candidates

// All runs at one machine.
class PlannedRuns {
 public:
  PlannedRuns(const Campaign& campaign, const Values& machine)
      : linear_(campaign, campaign.runs(), machine) {
    runs_.resize(linear_.count());
    estimation::InParallel(runs_.size(), [&](std::size_t run) { runs_[run] = linear_.At(run); });
  }

  MatrixXd Information(const std::vector<Candidate>& candidates) const {
    std::vector<RunSums> sums(runs_.size());
    estimation::InParallel(
        sums.size(), [&](std::size_t run) { sums[run] = linear_.SumsOf(runs_[run], candidates); });
    return linear_.Information(PointersTo(sums));
  }

 private:
  LinearRuns linear_;
  std::vector<LinearizedRun> runs_;
};

VectorXd PlausibleOf(const Candidate& candidate) {
  return candidate.cause->IsBinary() ? VectorXd::Ones(1) : candidate.Plausible();
}

// The best shape of each name; shapes of one name stand together.
void Keep(const PlannedCause& cause, std::vector<PlannedCause>& best) {
  if (best.empty() || best.back().candidate.Name() != cause.candidate.Name()) {
    best.push_back(cause);
  } else if (cause.visible > best.back().visible) {
    best.back() = cause;
  }
}

std::vector<PlannedCause> VisibleOf(const PlannedRuns& runs,
                                    const std::vector<Candidate>& candidates) {
  const VectorXd information = runs.Information(candidates).diagonal();
  std::vector<PlannedCause> causes;
  Index at = 0;
  for (const Candidate& each : candidates) {
    const VectorXd plausible = PlausibleOf(each);
    PlannedCause cause{each};
    const VectorXd own = information.segment(at, plausible.size()).cwiseMax(0.0);
    const VectorXd each_visible = plausible.cwiseProduct(own.cwiseSqrt());
    cause.visible = each_visible.maxCoeff(&cause.coefficient);
    if (each.cause->IsRandomField()) cause.visible = each_visible.norm();
    causes.push_back(std::move(cause));
    at += plausible.size();
  }
  return causes;
}

std::vector<PlannedCause> BestOf(const PlannedRuns& runs,
                                 const std::vector<Candidate>& candidates) {
  std::vector<std::vector<PlannedCause>> of_parts((candidates.size() + kAtOnce - 1) / kAtOnce);
  estimation::InParallel(of_parts.size(), [&](std::size_t part) {
    const std::size_t first = part * kAtOnce, last = std::min(first + kAtOnce, candidates.size());
    of_parts[part] = VisibleOf(runs, {candidates.begin() + first, candidates.begin() + last});
  });
  std::vector<PlannedCause> best;
  for (const auto& part : of_parts) {
    for (const PlannedCause& cause : part) Keep(cause, best);
  }
  return best;
}

// The part of a block of S that stands out, as columns W with W' S W = 1.
MatrixXd Standing(const MatrixXd& S) {
  constexpr double kStandsOut = 1.0;  // standard deviation
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(S);
  MatrixXd W(S.rows(), 0);
  for (Index i = 0; i < S.rows(); ++i) {
    const double information = solver.eigenvalues()[i];
    if (information < kStandsOut) continue;
    W.conservativeResize(Eigen::NoChange, W.cols() + 1);
    W.rightCols<1>() = solver.eigenvectors().col(i) / std::sqrt(information);
  }
  return W;
}

std::vector<Alike> AlikeOf(const PlannedRuns& runs, const std::vector<PlannedCause>& causes) {
  std::vector<std::size_t> seen;
  std::vector<Candidate> candidates;
  std::vector<Index> first{0};
  for (std::size_t i = 0; i < causes.size(); ++i) {
    if (!causes[i].seen()) continue;
    seen.push_back(i);
    candidates.push_back(causes[i].candidate);
    first.push_back(first.back() + PlausibleOf(candidates.back()).size());
  }
  std::vector<Alike> alike;
  if (seen.empty()) return alike;
  VectorXd plausible(first.back());
  for (std::size_t i = 0; i < seen.size(); ++i) {
    plausible.segment(first[i], first[i + 1] - first[i]) = PlausibleOf(candidates[i]);
  }
  const MatrixXd S = plausible.asDiagonal() * runs.Information(candidates) * plausible.asDiagonal();
  std::vector<std::vector<Alike>> of_first(seen.size());
  estimation::InParallel(seen.size(), [&](std::size_t a) {
    for (std::size_t b = a + 1; b < seen.size(); ++b) {
      const Index of_a = first[a + 1] - first[a], of_b = first[b + 1] - first[b];
      MatrixXd both(of_a + of_b, of_a + of_b);
      both << S.block(first[a], first[a], of_a, of_a), S.block(first[a], first[b], of_a, of_b),
          S.block(first[b], first[a], of_b, of_a), S.block(first[b], first[b], of_b, of_b);
      const double cosine = Likeness(both, of_a);
      if (cosine > kAlike) of_first[a].push_back({seen[a], seen[b], cosine});
    }
  });
  for (const auto& some : of_first) alike.insert(alike.end(), some.begin(), some.end());
  return alike;
}

}  // namespace

bool PlannedCause::seen() const { return visible >= kShowable; }

PlannedCause::Sizes PlannedCause::sizes() const {
  const simulation::Cause& cause = *candidate.cause;
  const auto keys_at = [&](double size) {
    VectorXd coefficients = VectorXd::Zero(cause.coefficients()), shape = candidate.shape;
    coefficients[coefficient] = size * cause.plausible[coefficient];
    if (cause.IsRandomField()) shape[0] *= size;
    return cause.ValuesOf(coefficients, shape);
  };
  Sizes sizes{keys_at(1.0), keys_at(kShowable / visible)};
  const VectorXd half = keys_at(0.5);
  for (Index i = 0; i < half.size(); ++i) {
    if (sizes.plausible[i] != half[i]) continue;
    sizes.plausible[i] = sizes.seen[i] = std::numeric_limits<double>::quiet_NaN();
  }
  return sizes;
}

double Likeness(const MatrixXd& S, Index count) {
  const Index other = S.rows() - count;
  const MatrixXd a = Standing(S.topLeftCorner(count, count));
  const MatrixXd b = Standing(S.bottomRightCorner(other, other));
  const Index directions = std::min(a.cols(), b.cols());
  if (directions == 0) return 0.0;
  const MatrixXd cross = a.transpose() * S.topRightCorner(count, other) * b;
  return cross.norm() / std::sqrt(directions);
}

Plan PlanOf(const Campaign& campaign, const std::function<double()>& normal) {
  const PlannedRuns runs(campaign, DrawnMachine(campaign, normal));
  Plan plan;
  plan.causes = BestOf(runs, AllCandidates(campaign.scene()));
  plan.alike = AlikeOf(runs, plan.causes);
  plan.standing = StandingPairs(campaign.scene());
  return plan;
}

}  // namespace abbe::diagnosis
