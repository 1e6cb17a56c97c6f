#include "estimation/monte_carlo.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "failure/failure.h"
#include "failure/interruption.h"

namespace abbe::estimation {
namespace {

constexpr double kFewestBlocks = 10.0;

// Mean, standard uncertainty, low and high: the figures that have to be stable.
using Figures = std::array<double, 4>;

Figures FiguresOf(const MonteCarloOutput& output) {
  return {output.mean, output.standard_uncertainty, output.low, output.high};
}

// Mean and sum of squared deviations of each figure over the blocks so far (Welford).
struct BlockStatistics {
  Figures mean{};
  Figures square{};
  double count = 0.0;

  void Add(const Figures& figures) {
    count += 1.0;
    for (std::size_t i = 0; i < figures.size(); ++i) {
      const double off = figures[i] - mean[i];
      mean[i] += off / count;
      square[i] += off * (figures[i] - mean[i]);
    }
  }

  bool SettledWithin(double tolerance) const {
    if (count < kFewestBlocks) return false;
    return std::all_of(square.begin(), square.end(), [&](double s) {
      return 2.0 * std::sqrt(s / (count * (count - 1.0))) <= tolerance;
    });
  }
};

// JCGM 101, 7.9.2: half of the last wanted digit of u.
double NumericalTolerance(double uncertainty, int digits) {
  if (!(uncertainty > 0.0)) return 0.0;
  const double exponent = std::floor(std::log10(uncertainty)) - (digits - 1);
  return 0.5 * std::pow(10.0, exponent);
}

class Draws {
 public:
  Draws(std::size_t output_count, const MonteCarloModel& model)
      : model_(model), columns_(output_count) {}

  // Appends the draws [first, first + count).
  void Append(std::uint64_t first, std::uint64_t count) {
    MayBeInterrupted();
    for (auto& column : columns_) column.resize(first + count);
    tbb::parallel_for(tbb::blocked_range<std::uint64_t>(first, first + count, 256),
                      [&](auto range) {
                        std::vector<double> outputs(columns_.size());
                        for (std::uint64_t draw = range.begin(); draw != range.end(); ++draw) {
                          model_(draw, outputs);
                          Store(draw, outputs);
                        }
                      });
  }

  std::vector<double>& column(std::size_t output) { return columns_[output]; }

 private:
  void Store(std::uint64_t draw, const std::vector<double>& outputs) {
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      if (!std::isfinite(outputs[i])) {
        throw NumericalError(fmt::format(
            "Monte Carlo: output {} of draw {} is not finite; keep the inputs inside the model's "
            "domain",
            i, draw));
      }
      columns_[i][draw] = outputs[i];
    }
  }

  const MonteCarloModel& model_;
  std::vector<std::vector<double>> columns_;
};

MonteCarloResult Run(std::size_t output_count, const MonteCarloModel& model,
                     const MonteCarloOptions& options) {
  const auto fewest = static_cast<std::uint64_t>(std::ceil(100.0 / (1.0 - options.probability)));
  const std::uint64_t block = std::max(options.block, fewest);
  Draws draws(output_count, model);
  std::vector<BlockStatistics> statistics(output_count);
  MonteCarloResult result;
  result.outputs.resize(output_count);
  std::vector<double> scratch;
  while (!result.stabilised && result.draws < block * options.max_blocks) {
    draws.Append(result.draws, block);
    result.stabilised = true;
    for (std::size_t i = 0; i < output_count; ++i) {
      const auto from = draws.column(i).begin() + result.draws;
      scratch.assign(from, draws.column(i).end());
      statistics[i].Add(FiguresOf(SummariseDraws(scratch, options.probability)));
      const double tolerance =
          NumericalTolerance(statistics[i].mean[1], options.significant_digits);
      result.outputs[i].tolerance = tolerance;
      result.stabilised &= statistics[i].SettledWithin(tolerance);
    }
    result.draws += block;
  }
  for (std::size_t i = 0; i < output_count; ++i) {
    const double tolerance = result.outputs[i].tolerance;
    result.outputs[i] = SummariseDraws(draws.column(i), options.probability);
    result.outputs[i].tolerance = tolerance;
  }
  return result;
}

}  // namespace

MonteCarloOutput SummariseDraws(std::span<double> draws, double probability) {
  if (draws.size() < 2) {
    throw NumericalError(
        fmt::format("Monte Carlo: {} draws have no uncertainty; take at least 2", draws.size()));
  }
  const double n = draws.size();
  MonteCarloOutput output;
  double sum = 0.0;
  for (const double draw : draws) sum += draw - draws[0];
  output.mean = draws[0] + sum / n;
  double square = 0.0;
  for (const double draw : draws) square += (draw - output.mean) * (draw - output.mean);
  output.standard_uncertainty = std::sqrt(square / (n - 1.0));
  // 7.7.2: q of the M draws lie inside, half of the rest below. Ranks count from 1 there.
  const double inside = std::floor(probability * n + 0.5);
  const auto low = static_cast<std::ptrdiff_t>(std::max(1.0, std::floor((n - inside + 1.0) / 2.0)));
  const auto high = std::min(low + static_cast<std::ptrdiff_t>(inside), std::ssize(draws));
  const auto low_at = draws.begin() + (low - 1);
  const auto high_at = draws.begin() + (high - 1);
  std::nth_element(draws.begin(), low_at, draws.end());
  output.low = *low_at;
  std::nth_element(low_at, high_at, draws.end());
  output.high = *high_at;
  return output;
}

MonteCarloResult PropagateDistributions(std::size_t output_count, const MonteCarloModel& model,
                                        const MonteCarloOptions& options) {
  if (!(options.probability > 0.0 && options.probability < 1.0)) {
    throw NumericalError(
        fmt::format("Monte Carlo: probability {} is not between 0 and 1", options.probability));
  }
  const int cores = tbb::info::default_concurrency();
  tbb::task_arena arena(options.threads > 0 ? std::min(options.threads, cores) : cores);
  return arena.execute([&] { return Run(output_count, model, options); });
}

}  // namespace abbe::estimation
