#include "track/linear_run.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "estimation/linearization.h"
#include "failure/failure.h"
#include "fusion/machine_problem.h"
#include "fusion/marginal.h"
#include "fusion/reversals.h"
#include "simulation/linkage/linkage_problem.h"

namespace abbe::track {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using estimation::ParameterBlock;
using simulation::SimulatedRun;

constexpr const char* kStateSource = "state";
constexpr double kSettled = 1e-3, kTolerated = 0.3;  // standard uncertainties
constexpr double kRowsOfPrior = 20.0, kNoiseSeen = 4.0;
constexpr double kRounding = 1e-12;    // of correlations
constexpr double kHardlyKnown = 1e-4;  // of the weight of what is known

using Numbers = std::map<std::string, int>;  // name -> entry of the state

Numbers NumbersOf(const std::vector<std::string>& names) {
  Numbers numbers;
  for (std::size_t i = 0; i < names.size(); ++i) numbers.emplace(names[i], static_cast<int>(i));
  return numbers;
}

// The runs with the state as the prior of what it knows.
class Fit {
 public:
  Fit(const std::vector<SimulatedRun>& runs, const Numbers& numbers, const Gaussian& state)
      : numbers_(numbers) {
    std::map<std::string, estimation::BlockId> known;
    for (const SimulatedRun& run : runs) {
      for (const ParameterBlock& block : run.blocks) AddBlock(block, state, known);
    }
    for (const SimulatedRun& run : runs) {
      std::vector<estimation::Input> inputs;
      for (const ParameterBlock& block : run.blocks) inputs.emplace_back(known.at(block.name));
      const auto source = problem_.AddSource(
          fmt::format("{} ({})", run.name, problem_.sources().size() + 1), {.loss = run.loss});
      problem_.Add(source, run.residual, inputs, 1.0);
    }
    AddState(state);
  }

  void Solve() {
    fit_ = simulation::SolveLinkage(problem_, 0, false, kSettled, kTolerated);
    for (const ParameterBlock& block : fit_.blocks) {
      auto& entries = problem_.Block(problem_.Find(block.name)).entries;
      for (std::size_t i = 0; i < entries.size(); ++i) entries[i].value = block.entries[i].value;
    }
  }

  const estimation::Result& result() const { return fit_; }

  LinearRun Linear(std::size_t runs) const {
    const estimation::Layout layout(problem_);
    const auto at =
        estimation::Linearize(problem_, layout, fusion::ValuesFound(fit_, fit_.blocks), 0);
    if (!at.trouble.empty()) throw NumericalError(at.trouble);
    LinearRun linear;
    fusion::Score all{at.prior.information, at.prior.gradient};
    linear.unexplained = Unexplained(at, runs);
    for (std::size_t r = 0; r < runs; ++r) {
      const double noise = NoiseOf(fit_.sources[r].chi_square, fit_.sources[r].redundancy);
      all.information += at.sources[r].information / (noise * noise);
      all.score += at.sources[r].gradient / (noise * noise);
      linear.noise = std::max(linear.noise, noise);
    }
    std::vector<int> kept, own;
    VectorXd x(layout.columns());
    const VectorXd values = fusion::ValuesFound(fit_, fit_.blocks);
    for (int column = 0; column < layout.columns(); ++column) {
      x[column] = values[layout.entry_of_column[column]];
      const auto entry = numbers_.find(layout.names[column]);
      if (entry == numbers_.end()) {
        if (all.information(column, column) > 0.0) own.push_back(column);
      } else {
        kept.push_back(column);
        linear.test.entries.push_back(entry->second);
      }
    }
    fusion::Score left = fusion::WithoutNuisance(all, kept, own);
    linear.test.information = 0.5 * (left.information + left.information.transpose());
    linear.test.vector = linear.test.information * x(kept) - left.score;
    return linear;
  }

 private:
  void AddBlock(ParameterBlock block, const Gaussian& state,
                std::map<std::string, estimation::BlockId>& known) {
    if (const auto at = known.find(block.name); at != known.end()) {
      if (problem_.Block(at->second).size() == block.size()) return;
      throw InputError(fmt::format("{} has {} numbers in one run and {} in another", block.name,
                                   problem_.Block(at->second).size(), block.size()));
    }
    // An axis reverses as the map says it does.
    if (fusion::IsReversal(block) && !numbers_.contains(block.FullName(0))) block.Hold();
    for (std::size_t i = 0; i < block.entries.size(); ++i) {
      const auto entry = numbers_.find(block.FullName(i));
      if (entry == numbers_.end()) continue;
      block.entries[i].value = state.mean[entry->second];
      block.entries[i].prior_sd = estimation::kNoPrior;
    }
    const std::string name = block.name;
    known.emplace(name, problem_.Add(std::move(block)));
  }

  // |L^-1 (x - mean)|^2 over the entries of the state that are free here.
  void AddState(const Gaussian& state) {
    std::vector<int> entries;
    std::vector<estimation::Input> inputs;
    for (std::size_t b = 0; b < problem_.blocks().size(); ++b) {
      const ParameterBlock& block = problem_.blocks()[b];
      for (std::size_t i = 0; i < block.entries.size(); ++i) {
        const auto entry = numbers_.find(block.FullName(i));
        if (entry == numbers_.end() || block.entries[i].held) continue;
        entries.push_back(entry->second);
        inputs.emplace_back(estimation::BlockId{static_cast<int>(b)}, static_cast<int>(i), 1);
      }
    }
    const MatrixXd S = state.root(entries, Eigen::all);
    MatrixXd P = S * S.transpose();
    const VectorXd inverse = P.diagonal().cwiseSqrt().cwiseInverse();
    if (!inverse.allFinite()) {
      throw InputError("the map knows a parameter of this run without any uncertainty");
    }
    P = inverse.asDiagonal() * P * inverse.asDiagonal();
    P.diagonal().array() += kRounding;
    const Eigen::LLT<MatrixXd> factor(P);
    const MatrixXd W = factor.matrixL().solve(MatrixXd(inverse.asDiagonal()));
    const auto source = problem_.AddSource(kStateSource, {.is_prior = true});
    problem_.Add(source, std::make_shared<estimation::LinearResidual>(W, W * state.mean(entries)),
                 inputs, 1.0);
  }

  // One step to the fit of the rows with hardly any prior.
  double Unexplained(const estimation::Linearization& at, std::size_t runs) const {
    MatrixXd information = kHardlyKnown * (at.prior.information + at.sources.back().information);
    VectorXd gradient = kHardlyKnown * (at.prior.gradient + at.sources.back().gradient);
    double chi_square = 0.0, rows = 0.0;
    MatrixXd of_rows = MatrixXd::Zero(information.rows(), information.cols());
    VectorXd by_rows = VectorXd::Zero(gradient.size());
    for (std::size_t r = 0; r < runs; ++r) {
      of_rows += at.sources[r].information;
      by_rows += at.sources[r].gradient;
      chi_square += at.sources[r].chi_square;
      rows += static_cast<double>(problem_.sources()[r].rows);
    }
    information += of_rows;
    gradient += by_rows;
    const VectorXd scale = (information.diagonal().array() > 0.0)
                               .select(information.diagonal().cwiseSqrt().cwiseInverse(), 1.0);
    MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
    scaled.diagonal().array() += kRounding;
    const Eigen::LLT<MatrixXd> factor(scaled);
    const VectorXd step = -scale.cwiseProduct(factor.solve(scale.cwiseProduct(gradient)));
    const double told =
        factor.solve(MatrixXd(scale.asDiagonal() * of_rows * scale.asDiagonal())).trace();
    return NoiseOf(chi_square + 2.0 * by_rows.dot(step) + step.dot(of_rows * step), rows - told);
  }

  static double NoiseOf(double chi_square, double rows) {
    const double redundancy = std::max(rows, 0.0) + kRowsOfPrior;
    const double square = (chi_square + kRowsOfPrior) / redundancy;
    return std::abs(square - 1.0) * std::sqrt(redundancy / 2.0) > kNoiseSeen ? std::sqrt(square)
                                                                             : 1.0;
  }

  const Numbers& numbers_;
  estimation::Problem problem_;
  estimation::Result fit_;
};

}  // namespace

LinearRun Linearize(std::vector<SimulatedRun> runs, const std::vector<std::string>& names,
                    const Gaussian& state) {
  const Numbers numbers = NumbersOf(names);
  Fit first(runs, numbers, state);
  first.Solve();
  bool condensed = false;
  for (SimulatedRun& run : runs) {
    if (!run.condense) continue;
    run.residual = run.condense(fusion::ValuesFound(first.result(), run.blocks));
    run.condense = nullptr;
    condensed = true;
  }
  if (!condensed) return first.Linear(runs.size());
  // The rows of a long run, gathered around the fit.
  for (SimulatedRun& run : runs) {
    for (ParameterBlock& block : run.blocks) {
      const ParameterBlock& found = first.result().Block(block.name);
      for (std::size_t i = 0; i < block.entries.size(); ++i) {
        block.entries[i].value = found.entries[i].value;
      }
    }
  }
  Fit second(runs, numbers, state);
  second.Solve();
  return second.Linear(runs.size());
}

}  // namespace abbe::track
