#include "learned/confounding.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/linear_runs.h"
#include "diagnosis/shortlist.h"

namespace abbe::learned {
namespace {

using diagnosis::Candidate;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Likeness {
  std::string name;
  double cosine;
};

// The share of the term's effect, as a cosine, in what a cause spans.
double CosineOf(const MatrixXd& of_cause, const VectorXd& with_term, double of_term) {
  constexpr double kAbsorbed = 1e-8;
  if (!(of_term > 0.0) || of_cause.size() == 0) return 0.0;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(of_cause);
  double share = 0.0;
  for (Index i = 0; i < with_term.size(); ++i) {
    const double value = eigen.eigenvalues()[i];
    if (!(value > kAbsorbed * eigen.eigenvalues().maxCoeff())) continue;
    share += std::pow(eigen.eigenvectors().col(i).dot(with_term), 2) / value;
  }
  return std::sqrt(std::min(1.0, share / of_term));
}

}  // namespace

Confounding ConfoundingOf(const diagnosis::Fit& fit, const Candidate& term,
                          const std::shared_ptr<const diagnosis::Fit>& base,
                          const std::vector<Candidate>& causes) {
  const diagnosis::Campaign& campaign = base->campaign();
  const auto all = diagnosis::AllCandidates(
      campaign.scene(), diagnosis::CoarsenessOf(campaign.instruments().machine.population));
  std::vector<Candidate> candidates{term};
  for (const diagnosis::Named& named : diagnosis::Shortlist(*base, all)) {
    const Candidate& candidate = named.best.candidate;
    if (!candidate.cause->IsRandomField() && !diagnosis::IsAmong(causes, candidate)) {
      candidates.push_back(candidate);
    }
  }
  const diagnosis::LinearRuns linear(campaign, campaign.runs(),
                                     diagnosis::ValuesOf(base->result()));
  std::vector<diagnosis::RunSums> sums;
  for (std::size_t run = 0; run < linear.count(); ++run) {
    sums.push_back(linear.SumsOf(linear.At(run), candidates));
  }
  const MatrixXd S = linear.Information(diagnosis::PointersTo(sums));
  const Index own = term.cause->coefficients();
  MatrixXd C_C = MatrixXd::Zero(own, own);
  for (const auto& each : sums) C_C += each.C_C.topLeftCorner(own, own);
  VectorXd along = VectorXd::Ones(own);
  for (std::size_t i = 0; i < fit.taken_in().size(); ++i) {
    if (fit.taken_in()[i].Name() == term.Name()) along = fit.ScoreOf(i).coefficients;
  }
  const double whole = along.dot(C_C * along),
               of_term = along.dot(S.topLeftCorner(own, own) * along);
  Confounding confounding;
  if (whole > 0.0) {
    confounding.imitated = 1.0 - std::sqrt(std::clamp(of_term / whole, 0.0, 1.0));
  }
  std::vector<Likeness> alike;
  Index first = own;
  for (std::size_t i = 1; i < candidates.size(); ++i) {
    const Index count = candidates[i].cause->coefficients();
    const VectorXd with_term = S.block(first, 0, count, own) * along;
    alike.push_back({candidates[i].Name(),
                     CosineOf(S.block(first, first, count, count), with_term, of_term)});
    first += count;
  }
  std::ranges::stable_sort(alike, std::greater(), &Likeness::cosine);
  if (!alike.empty() && alike.front().cosine > 0.0) {
    confounding.nearest = alike.front().name;
    confounding.cosine = alike.front().cosine;
  }
  for (const Likeness& each : alike) {
    if (each.cosine > kAlike) confounding.group.push_back(each.name);
  }
  return confounding;
}

}  // namespace abbe::learned
