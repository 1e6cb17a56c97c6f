#include "estimation/passes.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "failure/failure.h"

namespace abbe::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kRounding = 1e-12;  // of the normal equations, as in weak_directions.h
// A reciprocal condition in the 1-norm, which is below that of the eigenvalues, with a margin for
// its being an estimate.
constexpr double kAllSeen = 10.0 * kRounding;
// Far below 1: what the data hardly see may be the bottom of a curved valley, where the undamped
// step leaves the valley and a strong damping creeps.
constexpr double kFirstDamping = 1e-10;
constexpr double kMostDamping = 1e8;
// A cost is a sum of many squares; two of them are equal when they agree to this.
constexpr double kCostRounding = 1e-11;

// The normal equations with columns scaled to 1, ready to be solved for any damping.
class NormalEquations {
 public:
  explicit NormalEquations(const Linearization& at) : gradient_(at.Gradient()) {
    scaled_ = at.prior.information;
    for (const SourceSums& source : at.sources) scaled_ += source.information;
    scale_ = scaled_.diagonal();
    for (double& s : scale_) s = s > 0.0 ? 1.0 / std::sqrt(s) : 0.0;
    scaled_ = scale_.asDiagonal() * scaled_ * scale_.asDiagonal();
    const Eigen::LLT<MatrixXd> factor(scaled_);
    if (factor.info() == Eigen::Success && factor.rcond() > kAllSeen) {
      undamped_ = Solved(factor);
    } else {
      Decompose();
      undamped_ = Step(0.0);
    }
  }

  VectorXd Step(double damping) const {
    if (along_.size() == 0) {
      if (damping == 0.0) return undamped_;
      MatrixXd damped = scaled_;
      damped.diagonal().array() += damping;
      return Solved(Eigen::LLT<MatrixXd>(damped));
    }
    VectorXd step = along_;
    for (Index i = 0; i < step.size(); ++i) {
      if (step[i] != 0.0) step[i] /= eigen_.eigenvalues()[i] + damping;
    }
    return scale_.cwiseProduct(eigen_.eigenvectors() * step);
  }

  // Length of the undamped step in standard uncertainties.
  double Length() const { return std::sqrt(std::max(0.0, -gradient_.dot(undamped_))); }

  // The parameter that the step moves most, on the scale of its own information.
  Index MovesMost() const {
    Index most = 0;
    double largest = -1.0;
    for (Index i = 0; i < undamped_.size(); ++i) {
      const double moved = scale_[i] > 0.0 ? std::abs(undamped_[i]) / scale_[i] : 0.0;
      if (moved > largest) {
        largest = moved;
        most = i;
      }
    }
    return most;
  }

 private:
  VectorXd Solved(const Eigen::LLT<MatrixXd>& factor) const {
    return -scale_.cwiseProduct(factor.solve(scale_.cwiseProduct(gradient_)));
  }

  // Where rounding hides a direction: it stays where it is.
  void Decompose() {
    eigen_.compute(scaled_);
    along_ = -eigen_.eigenvectors().transpose() * scale_.cwiseProduct(gradient_);
    const double largest = eigen_.eigenvalues().maxCoeff();
    for (Index i = 0; i < along_.size(); ++i) {
      if (eigen_.eigenvalues()[i] <= kRounding * largest) along_[i] = 0.0;
    }
  }

  VectorXd gradient_, scale_, undamped_;
  MatrixXd scaled_;
  VectorXd along_;  // empty when the data and the priors see every direction
  Eigen::SelfAdjointEigenSolver<MatrixXd> eigen_;
};

std::string PullsMost(const Problem& problem, const Linearization& at, const VectorXd& step) {
  std::string name(kPriorSource);
  double most = std::abs(at.prior.gradient.dot(step));
  for (std::size_t s = 0; s < at.sources.size(); ++s) {
    const double pull = std::abs(at.sources[s].gradient.dot(step));
    if (pull > most) {
      most = pull;
      name = problem.sources()[s].name;
    }
  }
  return name;
}

VectorXd Moved(const Layout& layout, VectorXd x, const VectorXd& step) {
  for (Index c = 0; c < step.size(); ++c) {
    x[layout.entry_of_column[static_cast<std::size_t>(c)]] += step[c];
  }
  return x;
}

[[noreturn]] void RefuseUnsettled(const Problem& problem, const Layout& layout,
                                  const Linearization& at, int passes, const std::string& trouble) {
  const NormalEquations equations(at);
  throw NumericalError(fmt::format(
      "the fit did not settle in {} passes: the next step is {:.2g} standard uncertainties long, "
      "parameter {} moves most, source '{}' pulls most{}; start nearer or state priors",
      passes, equations.Length(), layout.names[static_cast<std::size_t>(equations.MovesMost())],
      PullsMost(problem, at, equations.Step(0.0)),
      trouble.empty() ? "" : " (a step was refused: " + trouble + ")"));
}

}  // namespace

Settled SettleByPasses(const Problem& problem, const Layout& layout, const SolveOptions& options,
                       VectorXd x, Linearization at) {
  Settled now{std::move(x), std::move(at), 0};
  if (layout.columns() == 0) return now;
  double damping = 0.0;
  std::string trouble;
  NormalEquations equations(now.at);
  // One pass at least: a linear problem then is exact, however far Ceres went.
  while (now.passes == 0 || equations.Length() > options.settled) {
    if (now.passes == options.max_iterations || damping > kMostDamping) {
      RefuseUnsettled(problem, layout, now.at, now.passes, trouble);
    }
    VectorXd trial = Moved(layout, now.x, equations.Step(damping));
    Linearization there = Linearize(problem, layout, trial, options.threads);
    ++now.passes;
    const double cost = now.at.Cost();
    const bool last = equations.Length() <= options.settled;
    if (there.trouble.empty() && (last || there.Cost() <= cost + kCostRounding * cost)) {
      now.x = std::move(trial);
      now.at = std::move(there);
      equations = NormalEquations(now.at);
      damping = damping > kFirstDamping ? damping / 10.0 : 0.0;
    } else {
      if (last) break;
      trouble = there.trouble;
      damping = std::max(10.0 * damping, kFirstDamping);
    }
  }
  return now;
}

}  // namespace abbe::estimation
