#include "estimation/sobol_indices.h"

#include <fmt/format.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>

#include "failure/failure.h"

namespace abbe::estimation {
namespace {

constexpr std::uint64_t kBlock = 64;  // draws summed together, independent of the number of threads

// Sums over draws of the numerator n of an index and of its denominator d, the variance.
struct RatioSums {
  double n = 0, nn = 0, nd = 0;

  void Add(double numerator, double denominator) {
    n += numerator;
    nn += numerator * numerator;
    nd += numerator * denominator;
  }
  void Add(const RatioSums& other) {
    n += other.n;
    nn += other.nn;
    nd += other.nd;
  }
};

struct BlockSums {
  explicit BlockSums(std::size_t inputs) : first(inputs), total(inputs) {}
  double d = 0, dd = 0;
  std::vector<RatioSums> first, total;

  void Add(const BlockSums& other) {
    d += other.d;
    dd += other.dd;
    for (std::size_t i = 0; i < first.size(); ++i) {
      first[i].Add(other.first[i]);
      total[i].Add(other.total[i]);
    }
  }
};

class Scheme {
 public:
  Scheme(std::size_t inputs, std::size_t outputs, const SobolDraw& draw, const SobolModel& model)
      : inputs_(inputs), outputs_(outputs), draw_(draw), model_(model), centre_(outputs) {}

  // Subtracting any constant near the mean of the outputs lowers the variance of the first indices.
  void Centre(std::uint64_t draws) {
    std::vector<double> x(inputs_), y(outputs_);
    for (std::uint64_t n = 0; n < draws; ++n) {
      draw_(n, x);
      Run(n, x, y);
      for (std::size_t o = 0; o < outputs_; ++o) centre_[o] += y[o] / draws;
    }
  }

  BlockSums Sum(std::uint64_t from, std::uint64_t to) const {
    BlockSums sums(inputs_);
    std::vector<double> a(inputs_), b(inputs_), f_a(outputs_), f_b(outputs_), f_ab(outputs_);
    for (std::uint64_t n = from; n < to; ++n) {
      draw_(2 * n, a);
      draw_(2 * n + 1, b);
      Run(2 * n, a, f_a);
      Run(2 * n + 1, b, f_b);
      double d = 0;
      for (std::size_t o = 0; o < outputs_; ++o) d += (f_a[o] - f_b[o]) * (f_a[o] - f_b[o]) / 2;
      sums.d += d;
      sums.dd += d * d;
      for (std::size_t i = 0; i < inputs_; ++i) {
        std::swap(a[i], b[i]);  // A with column i from B
        Run(2 * n, a, f_ab);
        std::swap(a[i], b[i]);
        double first = 0, total = 0;
        for (std::size_t o = 0; o < outputs_; ++o) {
          const double change = f_ab[o] - f_a[o];
          first += (f_b[o] - centre_[o]) * change;
          total += change * change / 2;
        }
        sums.first[i].Add(first, d);
        sums.total[i].Add(total, d);
      }
    }
    return sums;
  }

 private:
  void Run(std::uint64_t draw, const std::vector<double>& x, std::vector<double>& y) const {
    model_(x, y);
    for (std::size_t o = 0; o < outputs_; ++o) {
      if (std::isfinite(y[o])) continue;
      throw NumericalError(fmt::format(
          "Sobol indices: output {} of draw {} is not finite; keep the inputs inside the model's "
          "domain",
          o, draw));
    }
  }

  std::size_t inputs_, outputs_;
  const SobolDraw& draw_;
  const SobolModel& model_;
  std::vector<double> centre_;
};

double Uncertainty(const RatioSums& sums, const BlockSums& all) {
  const double ratio = sums.n / all.d;
  const double square = sums.nn - 2 * ratio * sums.nd + ratio * ratio * all.dd;
  return std::sqrt(std::max(0.0, square)) / all.d;
}

}  // namespace

SobolResult SobolIndices(std::size_t input_count, std::size_t output_count, const SobolDraw& draw,
                         const SobolModel& model, const SobolOptions& options) {
  if (options.draws < 2) {
    throw NumericalError(
        fmt::format("Sobol indices: {} draws; take at least 2, better 1000", options.draws));
  }
  Scheme scheme(input_count, output_count, draw, model);
  scheme.Centre(std::min<std::uint64_t>(2 * options.draws, 1000));
  std::vector<BlockSums> blocks((options.draws + kBlock - 1) / kBlock, BlockSums(input_count));
  const int cores = tbb::info::default_concurrency();
  tbb::task_arena arena(options.threads > 0 ? std::min(options.threads, cores) : cores);
  arena.execute([&] {
    tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t block) {
      const std::uint64_t from = block * kBlock;
      blocks[block] = scheme.Sum(from, std::min(from + kBlock, options.draws));
    });
  });
  BlockSums all(input_count);
  for (const BlockSums& block : blocks) all.Add(block);
  if (!(all.d > 0)) throw NumericalError("Sobol indices: no output of the model varies");
  SobolResult result{all.d / options.draws, {}};
  for (std::size_t i = 0; i < input_count; ++i) {
    result.inputs.push_back({all.first[i].n / all.d, Uncertainty(all.first[i], all),
                             all.total[i].n / all.d, Uncertainty(all.total[i], all)});
  }
  return result;
}

}  // namespace abbe::estimation
