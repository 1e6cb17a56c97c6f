#include "estimation/sobol_indices.h"

#include <fmt/format.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "failure/failure.h"

namespace abbe::estimation {
namespace {

constexpr std::uint64_t kBlock = 64;  // draws summed together, independent of the number of threads

class Scheme {
 public:
  Scheme(std::size_t inputs, std::size_t outputs, const SobolDraw& draw, const SobolModel& model)
      : inputs_(inputs), outputs_(outputs), draw_(draw), model_(model), centre_(outputs) {}

  void Centre(std::uint64_t draws) {
    std::vector<double> x(inputs_), y(outputs_);
    for (std::uint64_t n = 0; n < draws; ++n) {
      draw_(n, x);
      Run(n, x, y);
      for (std::size_t o = 0; o < outputs_; ++o) centre_[o] += y[o] / draws;
    }
  }

  SobolSums None() const { return {inputs_, centre_}; }

  SobolSums Sum(std::uint64_t from, std::uint64_t to) const {
    SobolSums sums = None();
    std::vector<double> a(inputs_), b(inputs_), f_a(outputs_), f_b(outputs_), f_ab(outputs_);
    for (std::uint64_t n = from; n < to; ++n) {
      draw_(2 * n, a);
      draw_(2 * n + 1, b);
      Run(2 * n, a, f_a);
      Run(2 * n + 1, b, f_b);
      SobolSums::Draw of_draw = sums.Add(f_a, f_b);
      for (std::size_t i = 0; i < inputs_; ++i) {
        std::swap(a[i], b[i]);  // A with column i from B
        Run(2 * n, a, f_ab);
        std::swap(a[i], b[i]);
        of_draw.Add(i, f_ab);
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

}  // namespace

void SobolSums::RatioSums::Add(double numerator, double denominator) {
  n += numerator;
  nn += numerator * numerator;
  nd += numerator * denominator;
}

void SobolSums::RatioSums::Add(const RatioSums& other) {
  n += other.n;
  nn += other.nn;
  nd += other.nd;
}

SobolSums::SobolSums(std::size_t input_count, std::vector<double> centre)
    : centre_(std::move(centre)), first_(input_count), total_(input_count) {}

SobolSums::Draw::Draw(SobolSums& sums, std::span<const double> f_a, std::span<const double> f_b)
    : sums_(sums), f_a_(f_a), f_b_(f_b), d_(0) {
  for (std::size_t o = 0; o < f_a.size(); ++o) d_ += (f_a[o] - f_b[o]) * (f_a[o] - f_b[o]) / 2;
  sums_.d_ += d_;
  sums_.dd_ += d_ * d_;
  ++sums_.draws_;
}

void SobolSums::Draw::Add(std::size_t input, std::span<const double> f_ab) {
  double first = 0, total = 0;
  for (std::size_t o = 0; o < f_a_.size(); ++o) {
    const double change = f_ab[o] - f_a_[o];
    first += (f_b_[o] - sums_.centre_[o]) * change;
    total += change * change / 2;
  }
  sums_.first_[input].Add(first, d_);
  sums_.total_[input].Add(total, d_);
}

void SobolSums::Add(const SobolSums& other) {
  draws_ += other.draws_;
  d_ += other.d_;
  dd_ += other.dd_;
  for (std::size_t i = 0; i < first_.size(); ++i) {
    first_[i].Add(other.first_[i]);
    total_[i].Add(other.total_[i]);
  }
}

double SobolSums::Uncertainty(const RatioSums& sums) const {
  const double ratio = sums.n / d_;
  const double square = sums.nn - 2 * ratio * sums.nd + ratio * ratio * dd_;
  return std::sqrt(std::max(0.0, square)) / d_;
}

SobolResult SobolSums::Result() const {
  if (!(d_ > 0)) throw NumericalError("Sobol indices: no output of the model varies");
  SobolResult result{d_ / draws_, {}};
  for (std::size_t i = 0; i < first_.size(); ++i) {
    result.inputs.push_back({first_[i].n / d_, Uncertainty(first_[i]),  //
                             total_[i].n / d_, Uncertainty(total_[i])});
  }
  return result;
}

SobolResult SobolIndices(std::size_t input_count, std::size_t output_count, const SobolDraw& draw,
                         const SobolModel& model, const SobolOptions& options) {
  if (options.draws < 2) {
    throw NumericalError(
        fmt::format("Sobol indices: {} draws; take at least 2, better 1000", options.draws));
  }
  Scheme scheme(input_count, output_count, draw, model);
  scheme.Centre(std::min<std::uint64_t>(2 * options.draws, 1000));
  std::vector<SobolSums> blocks((options.draws + kBlock - 1) / kBlock, scheme.None());
  const int cores = tbb::info::default_concurrency();
  tbb::task_arena arena(options.threads > 0 ? std::min(options.threads, cores) : cores);
  arena.execute([&] {
    tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t block) {
      const std::uint64_t from = block * kBlock;
      blocks[block] = scheme.Sum(from, std::min(from + kBlock, options.draws));
    });
  });
  SobolSums all = scheme.None();
  for (const SobolSums& block : blocks) all.Add(block);
  return all.Result();
}

}  // namespace abbe::estimation
