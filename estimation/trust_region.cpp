#include "estimation/trust_region.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "failure/interruption.h"

namespace abbe::estimation {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Loose: one or two of the passes that follow do the rest.
constexpr double kFunctionTolerance = 1e-10;
constexpr double kStepTolerance = 1e-14;
// Below this many multiplications the QR of the dense Jacobian is fast, and it is the most
// accurate.
constexpr double kDenseQr = 5e8;

struct ArgumentPlace {
  int block;
  int entry;
};

// Block and position of each entry, for Ceres.
std::vector<ArgumentPlace> ArgumentPlaces(const Problem& problem) {
  std::vector<ArgumentPlace> places;
  for (std::size_t b = 0; b < problem.blocks().size(); ++b) {
    for (Index i = 0; i < problem.blocks()[b].size(); ++i) {
      places.push_back({static_cast<int>(b), static_cast<int>(i)});
    }
  }
  return places;
}

// sign(t) sqrt(rho(t)), whose square is the loss of the row, and its derivative by t.
std::pair<double, double> Robustify(const RobustLoss& loss, double t) {
  if (loss.kind == RobustLoss::Kind::kNone || std::abs(t) < 1e-8) return {t, 1.0};
  const double root = std::copysign(std::sqrt(loss.Rho(t)), t);
  return {root, loss.Weight(t) * t / root};
}

// A term as a cost function of Ceres: one Jacobian for each whole block.
class TermCost : public ceres::CostFunction {
 public:
  TermCost(const Problem& problem, const Term& term, const std::vector<ArgumentPlace>& places,
           std::exception_ptr& thrown)
      : term_(term), loss_(problem.sources()[term.source.index].options.loss), thrown_(thrown) {
    std::map<int, int> order;
    for (const int entry : term.entries) {
      const ArgumentPlace place = places[entry];
      const auto [at, is_new] = order.try_emplace(place.block, static_cast<int>(blocks_.size()));
      if (is_new) {
        blocks_.push_back(place.block);
        const ParameterBlock& block = problem.blocks()[place.block];
        mutable_parameter_block_sizes()->push_back(static_cast<int>(block.size()));
      }
      inputs_.push_back({at->second, place.entry});
    }
    set_num_residuals(static_cast<int>(term.residual->Rows()));
  }

  const std::vector<int>& blocks() const { return blocks_; }

  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override {
    VectorXd x(inputs_.size());
    for (std::size_t i = 0; i < inputs_.size(); ++i) {
      x[i] = parameters[inputs_[i].block][inputs_[i].entry];
    }
    VectorXd values(num_residuals());
    RowMatrix jacobian;
    if (jacobians != nullptr) jacobian.resize(num_residuals(), x.size());
    try {
      MayBeInterrupted();
      term_.residual->Evaluate(x, values, jacobians != nullptr ? &jacobian : nullptr);
    } catch (const NumericalError&) {
      return false;
    } catch (...) {
      thrown_ = std::current_exception();
      return false;
    }
    if (!values.allFinite() || !jacobian.allFinite()) return false;
    Store(values, jacobian, residuals, jacobians);
    return true;
  }

 private:
  void Store(const VectorXd& values, const RowMatrix& jacobian, double* residuals,
             double** jacobians) const {
    const VectorXd& sd = term_.standard_deviation;
    const auto& sizes = parameter_block_sizes();
    for (std::size_t b = 0; jacobians != nullptr && b < sizes.size(); ++b) {
      if (jacobians[b] != nullptr) std::fill_n(jacobians[b], num_residuals() * sizes[b], 0.0);
    }
    for (Index row = 0; row < values.size(); ++row) {
      const double whiten = 1.0 / sd[sd.size() == 1 ? 0 : row];
      const auto [residual, slope] = Robustify(loss_, values[row] * whiten);
      residuals[row] = residual;
      for (std::size_t i = 0; jacobians != nullptr && i < inputs_.size(); ++i) {
        const ArgumentPlace at = inputs_[i];
        double* of_block = jacobians[at.block];
        if (of_block == nullptr) continue;
        of_block[row * sizes[at.block] + at.entry] = jacobian(row, i) * whiten * slope;
      }
    }
  }

  const Term& term_;
  RobustLoss loss_;
  std::exception_ptr& thrown_;
  std::vector<int> blocks_;            // of the problem, in the order of the arguments
  std::vector<ArgumentPlace> inputs_;  // argument and entry of each input
};

// (x - nominal) / prior_sd for the free entries of a block that have a prior.
class PriorCost : public ceres::CostFunction {
 public:
  explicit PriorCost(const ParameterBlock& block) : block_(block) {
    for (std::size_t i = 0; i < block.entries.size(); ++i) {
      const Parameter& entry = block.entries[i];
      if (!entry.held && std::isfinite(entry.prior_sd)) entries_.push_back(i);
    }
    set_num_residuals(static_cast<int>(entries_.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(block.size()));
  }

  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override {
    const bool slopes = jacobians != nullptr && jacobians[0] != nullptr;
    const std::size_t width = block_.entries.size();
    if (slopes) std::fill_n(jacobians[0], entries_.size() * width, 0.0);
    for (std::size_t row = 0; row < entries_.size(); ++row) {
      const Parameter& entry = block_.entries[entries_[row]];
      residuals[row] = (parameters[0][entries_[row]] - entry.nominal) / entry.prior_sd;
      if (slopes) jacobians[0][row * width + entries_[row]] = 1.0 / entry.prior_sd;
    }
    return true;
  }

 private:
  const ParameterBlock& block_;
  std::vector<std::size_t> entries_;
};

class CeresProblem {
 public:
  CeresProblem(const Problem& problem, VectorXd& x) {
    double* next = x.data();
    for (const ParameterBlock& block : problem.blocks()) {
      pointers_.push_back(next);
      AddBlock(block, next);
      next += block.size();
    }
    const std::vector<ArgumentPlace> places = ArgumentPlaces(problem);
    for (const Term& term : problem.terms()) {
      auto cost = std::make_unique<TermCost>(problem, term, places, thrown_);
      std::vector<double*> arguments;
      for (const int block : cost->blocks()) {
        arguments.push_back(pointers_[block]);
      }
      ceres_.AddResidualBlock(cost.release(), nullptr, arguments);
    }
  }

  ceres::Problem& ceres() { return ceres_; }
  const std::exception_ptr& thrown() const { return thrown_; }

 private:
  void AddBlock(const ParameterBlock& block, double* at) {
    const int size = static_cast<int>(block.size());
    ceres_.AddParameterBlock(at, size);
    std::vector<int> held;
    for (int i = 0; i < size; ++i) {
      if (block.entries[i].held) held.push_back(i);
    }
    if (std::ssize(held) == size) {
      ceres_.SetParameterBlockConstant(at);
    } else if (!held.empty()) {
      ceres_.SetManifold(at, new ceres::SubsetManifold(size, held));
    }
    auto prior = std::make_unique<PriorCost>(block);
    if (prior->num_residuals() > 0) ceres_.AddResidualBlock(prior.release(), nullptr, at);
  }

  ceres::Problem ceres_;
  std::vector<double*> pointers_;
  std::exception_ptr thrown_;
};

ceres::LinearSolverType ChooseSolver(const Problem& problem, const Layout& layout) {
  double rows = 0.0;
  for (const Source& source : problem.sources()) rows += source.rows;
  const double n = layout.columns();
  if (rows * n * n < kDenseQr) return ceres::DENSE_QR;
  const double filled = static_cast<double>(JacobianBytes(problem, layout)) / sizeof(double);
  return filled < 0.3 * rows * n ? ceres::SPARSE_NORMAL_CHOLESKY : ceres::DENSE_NORMAL_CHOLESKY;
}

}  // namespace

std::size_t JacobianBytes(const Problem& problem, const Layout& layout) {
  const std::vector<ArgumentPlace> places = ArgumentPlaces(problem);
  std::vector<std::size_t> free_in_block(problem.blocks().size());
  for (const int entry : layout.entry_of_column) {
    ++free_in_block[places[entry].block];
  }
  std::size_t numbers = 0;
  for (const Term& term : problem.terms()) {
    std::size_t width = 0;
    int last = -1;
    for (const int entry : term.entries) {
      const int block = places[entry].block;
      if (block != last) width += free_in_block[block];
      last = block;
    }
    numbers += width * term.residual->Rows();
  }
  return numbers * sizeof(double);
}

int ApproachMinimum(const Problem& problem, const Layout& layout, const SolveOptions& options,
                    VectorXd& x) {
  CeresProblem model(problem, x);
  ceres::Solver::Options ceres_options;
  ceres_options.max_num_iterations = options.max_iterations;
  ceres_options.function_tolerance = kFunctionTolerance;
  ceres_options.parameter_tolerance = kStepTolerance;
  ceres_options.gradient_tolerance = 0.0;
  ceres_options.linear_solver_type = ChooseSolver(problem, layout);
  ceres_options.num_threads = 1;
  ceres_options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(ceres_options, &model.ceres(), &summary);
  if (model.thrown()) std::rethrow_exception(model.thrown());
  return static_cast<int>(summary.iterations.size());
}

}  // namespace abbe::estimation
