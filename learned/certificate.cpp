#include "learned/certificate.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "learned/learning.h"
#include "simulation/variables.h"

namespace abbe::learned {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::uint64_t kSeed = 1;

// 1 - (1 - p)^n for small p.
double AnyOf(double log_chance, double n) {
  return -std::expm1(n * std::log1p(-std::min(std::exp(log_chance), 0.5)));
}

// S^+ on the directions that are seen.
MatrixXd PseudoInverse(const MatrixXd& S) {
  constexpr double kAbsorbed = 1e-8;
  if (S.rows() == 0) return S;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(S);
  const double most = eigen.eigenvalues().maxCoeff();
  VectorXd inverse = VectorXd::Zero(S.rows());
  for (Index i = 0; i < S.rows(); ++i) {
    if (eigen.eigenvalues()[i] > kAbsorbed * most) inverse[i] = 1.0 / eigen.eigenvalues()[i];
  }
  return eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
}

struct Coefficient {
  double value = 0.0, information = 0.0;
};

// From some of the parts, what the channel does in the others free. The score is that beside the
// term, so the value is what these parts want of it more.
Coefficient CoefficientIn(const std::vector<Index>& own, const std::vector<Index>& others,
                          const PartScan& scan, const VectorXd& f) {
  const MatrixXd gain = scan.S(own, others) * PseudoInverse(scan.S(others, others));
  const MatrixXd S = scan.S(own, own) - gain * scan.S(others, own);
  const VectorXd g = scan.g(own) - gain * scan.g(others);
  const VectorXd of = f(own);
  const double information = of.dot(S * of);
  return {information > 0.0 ? of.dot(g) / information : 0.0, information};
}

}  // namespace

double ByChance(const TermSearch& search, bool is_smooth) {
  if (is_smooth) {
    const auto questions = static_cast<double>(search.structures);
    return std::clamp(std::exp(search.smooth->log_probability) * questions, 1e-300, 1.0);
  }
  const Rated& best = search.best.front();
  const double chance = LogChanceOf(best.chi_square, best.proposal.columns());
  const std::vector<double> least = LeastChances(search.scans, kDraws, kSeed);
  const double median = least[least.size() / 2];
  const double atoms = std::log(0.5) / std::log1p(-std::exp(median));
  const auto as_small =
      static_cast<double>(std::ranges::upper_bound(least, chance) - least.begin());
  constexpr double kEnough = 10.0;
  const double over_parts = as_small >= kEnough ? as_small / kDraws : AnyOf(chance, atoms);
  const double by_row = AnyOf(chance, static_cast<double>(search.asked_by_row));
  constexpr double kLeast = 1e-300;  // less is no number
  return std::clamp(over_parts + by_row, kLeast, 1.0);
}

std::string RegimeOf(const diagnosis::Fit& fit, const Learned& learned, std::size_t place) {
  constexpr double kTells = 3.0, kAgree = 3.0;  // standard uncertainties
  const simulation::LearnedTerm& term = learned.term();
  const auto& product = term.expression.terms.front();
  if (learned.is_smooth || product.size() != 1 || term.expression.terms.size() != 1 ||
      !IsAskedOfParts(product.front().form) || product.front().form == Atom::Form::kSign) {
    return simulation::kUntold;
  }
  const auto channel = simulation::ChannelNamed(term.object).value();
  const std::vector<PartScan> scans = ScanParts(fit, channel);
  const auto scan = std::ranges::find_if(scans, [&](const PartScan& each) {
    return each.variable == product.front().variable && !each.by_direction &&
           each.hats == (product.front().form != Atom::Form::kStep);
  });
  if (scan == scans.end()) return simulation::kUntold;
  std::vector<Index> inner, outer;
  constexpr Index kFifth = kParts / 5;
  for (Index part = 0; part < scan->at.size(); ++part) {
    (part < kFifth || part >= scan->at.size() - kFifth ? outer : inner).push_back(part);
  }
  const VectorXd f = OverParts(product.front(), *scan).row(0).transpose();
  const Coefficient in = CoefficientIn(inner, outer, *scan, f),
                    out = CoefficientIn(outer, inner, *scan, f);
  const double size = fit.ScoreOf(place).coefficients[0];
  if (std::abs(size) * std::sqrt(std::min(in.information, out.information)) < kTells) {
    return simulation::kUntold;
  }
  const double u = std::sqrt(1.0 / in.information + 1.0 / out.information);
  return std::abs(in.value - out.value) < kAgree * u ? simulation::kHolds : simulation::kFails;
}

}  // namespace abbe::learned
