// Propagation of distributions through a model by an adaptive Monte Carlo method.
//
// The adaptive procedure of JCGM 101 (GUM Supplement 1), 7.9. Draws come in blocks of M. Each block
// gives four figures: the mean, the standard uncertainty and both ends of the 95 % interval. After
// h blocks the procedure stops when, for each figure, twice the standard deviation of its average
// is within the numerical tolerance
//
//   delta = 10^l / 2,   u = c * 10^l, c an integer of the wanted number of digits
//
// The figures returned come from all h M draws together.
//
//   const random::CounterRandom length(seed, 0), temperature(seed, 1);
//   const auto result = PropagateDistributions(1, [&](std::uint64_t draw, std::span<double> out) {
//     out[0] = (1.0 + 3e-7 * length.Normal(draw)) *
//              (1.0 + kAlpha * temperature.Uniform(draw, -1.0, 1.0));
//   });
//   result.outputs[0].standard_uncertainty;  result.draws;  result.stabilised;
//
// The model is a pure function of the draw's index (random/counter_random.h): the result then is
// the same to the last bit for any number of threads. It is called from several threads at once.
// Units: the model's. Shapes: one entry of `outputs` for each output of the model.
// Failure: NumericalError when an output is not finite (which draw, which output). Exceptions of
// the model pass through. Without stability after max_blocks, `stabilised` is false.
// Source: JCGM 101:2008 (GUM Supplement 1), 7.9; 7.6 and 7.7.2 for the figures.
// Validity: the interval is the probabilistically symmetric one, not the shortest.
// Memory: 8 bytes for each draw and output. When not to use: a linear model has the same answer
// from the law of propagation of uncertainty, without draws.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace abbe::estimation {

struct MonteCarloOptions {
  double probability = 0.95;     // of the interval
  int significant_digits = 2;    // of the standard uncertainty
  std::uint64_t block = 10'000;  // M: draws of one block; at least 100 / (1 - probability)
  std::uint64_t max_blocks = 1'000;
  int threads = 0;  // 0: all; never more than the machine has
};

struct MonteCarloOutput {
  double mean = 0.0;
  double standard_uncertainty = 0.0;
  double low = 0.0;  // the probabilistically symmetric interval of `probability`
  double high = 0.0;
  double tolerance = 0.0;  // delta: the numerical error of the figures above when stabilised
};

struct MonteCarloResult {
  bool stabilised = false;
  std::uint64_t draws = 0;
  std::vector<MonteCarloOutput> outputs;
};

using MonteCarloModel = std::function<void(std::uint64_t draw, std::span<double> outputs)>;

// `output_count`: how many values the model writes for each draw.
MonteCarloResult PropagateDistributions(std::size_t output_count, const MonteCarloModel& model,
                                        const MonteCarloOptions& options = {});

// The figures of one sample (JCGM 101, 7.6 and 7.7.2); it is reordered. `tolerance` stays 0.
MonteCarloOutput SummariseDraws(std::span<double> draws, double probability = 0.95);

}  // namespace abbe::estimation
