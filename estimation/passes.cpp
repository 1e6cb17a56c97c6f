#include "estimation/passes.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "estimation/rounding.h"
#include "failure/failure.h"

namespace abbe::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Far below 1: a poorly determined direction may follow a curved valley of the cost, where the
// undamped step leaves the valley and a strong damping creeps.
constexpr double kFirstDamping = 1e-10;
constexpr double kNegligible = 1e-3;  // standard uncertainties: accepted after the last pass
constexpr double kMostDamping = 1e8;
// Relative rounding of a cost, a sum of many squares.
constexpr double kCostRounding = 1e-11;
constexpr double kFarOff = 3.0;  // ratio of scatter to stated noise that the advice mentions

// The normal equations with columns scaled to 1, solved for any damping.
class NormalEquations {
 public:
  explicit NormalEquations(const Linearization& at) : gradient_(at.Gradient()) {
    scaled_ = at.prior.information;
    for (const SourceSums& source : at.sources) scaled_ += source.information;
    scale_ = scaled_.diagonal();
    for (double& s : scale_) s = s > 0.0 ? 1.0 / std::sqrt(s) : 0.0;
    scaled_ = scale_.asDiagonal() * scaled_ * scale_.asDiagonal();
    const Eigen::LLT<MatrixXd> factor(scaled_);
    if (HasFullRank(factor)) {
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

  // False where rounding leaves no step.
  bool HasStep() const { return undamped_.allFinite(); }
  // Length of the undamped step in standard uncertainties.
  double Length() const { return std::sqrt(std::max(0.0, -gradient_.dot(undamped_))); }

  // The parameter with the largest step times the root of its own information.
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

  // For the case that rounding hides a direction: the step along it is 0.
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
  VectorXd along_;  // empty when data and priors determine every direction
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

VectorXd AddStep(const Layout& layout, VectorXd x, const VectorXd& step) {
  for (Index c = 0; c < step.size(); ++c) {
    x[layout.entry_of_column[c]] += step[c];
  }
  return x;
}

// Ratio of the scatter of a source to its stated noise, at least 1. A robust loss lowers it.
double Excess(const Source& source, const SourceSums& sums) {
  if (source.options.is_prior || source.rows == 0) return 1.0;
  return std::max(1.0, std::sqrt(sums.chi_square / source.rows));
}

// The largest step that counts as converged. Where the rows scatter beyond their stated noise, the
// standard uncertainties are too small a scale, and a robust loss approaches its minimum slowly.
double ConvergedLength(const Problem& problem, const Linearization& at, double settled) {
  constexpr double kMostExcess = 10.0;
  double chi_square = 0.0, rows = 0.0;
  for (std::size_t s = 0; s < at.sources.size(); ++s) {
    if (problem.sources()[s].options.is_prior) continue;
    chi_square += at.sources[s].chi_square;
    rows += problem.sources()[s].rows;
  }
  const double excess = rows > 0.0 ? std::sqrt(chi_square / rows) : 1.0;
  return settled * std::clamp(excess, 1.0, kMostExcess);
}

// Advice for a fit that does not converge.
std::string Advice(const Problem& problem, const Linearization& at) {
  std::size_t worst = 0;
  double most = 0.0;
  for (std::size_t s = 0; s < at.sources.size(); ++s) {
    const double excess = Excess(problem.sources()[s], at.sources[s]);
    if (excess > most) {
      most = excess;
      worst = s;
    }
  }
  if (most < kFarOff) return "start nearer or state priors";
  return fmt::format(
      "the rows of '{}' scatter at least {:.1f} times the noise that is stated for them: state it "
      "larger, or look whether that source belongs to this model",
      problem.sources()[worst].name, most);
}

[[noreturn]] void RefuseUnconverged(const Problem& problem, const Layout& layout,
                                    const Linearization& at, int passes,
                                    const std::string& trouble) {
  const NormalEquations equations(at);
  throw NumericalError(fmt::format(
      "the fit did not converge in {} passes: the next step is {:.2g} standard uncertainties long, "
      "parameter {} moves most, source '{}' pulls most{}; {}",
      passes, equations.Length(), layout.names[equations.MovesMost()],
      PullsMost(problem, at, equations.Step(0.0)),
      trouble.empty() ? "" : " (a step was refused: " + trouble + ")", Advice(problem, at)));
}

}  // namespace

Minimum FindMinimum(const Problem& problem, const Layout& layout, const SolveOptions& options,
                    VectorXd x, Linearization at) {
  Minimum now{std::move(x), std::move(at), 0};
  if (layout.columns() == 0) return now;
  double damping = 0.0;
  bool tolerable = false;
  std::string trouble;
  NormalEquations equations(now.at);
  // One pass at least: it solves a linear problem exactly, also where Ceres stopped early.
  while (now.passes == 0 || !equations.HasStep() ||
         equations.Length() > ConvergedLength(problem, now.at, options.settled)) {
    if (!equations.HasStep()) {
      RefuseUnconverged(problem, layout, now.at, now.passes,
                        "the normal equations are singular to rounding");
    }
    tolerable |= equations.Length() <= ConvergedLength(problem, now.at, options.tolerated);
    if (now.passes == options.max_iterations || damping > kMostDamping) {
      if (tolerable || equations.Length() < kNegligible) break;
      RefuseUnconverged(problem, layout, now.at, now.passes, trouble);
    }
    VectorXd trial = AddStep(layout, now.x, equations.Step(damping));
    Linearization there = Linearize(problem, layout, trial, options.threads);
    ++now.passes;
    const double cost = now.at.Cost();
    const bool last = equations.Length() <= ConvergedLength(problem, now.at, options.settled);
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
