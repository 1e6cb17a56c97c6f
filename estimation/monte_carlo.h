// Propagates distributions through a model by drawing from them, until the answer has settled.
//
// The adaptive procedure of JCGM 101 (GUM Supplement 1), 7.9. Draws come in blocks of M. Of every
// block the mean, the standard uncertainty and both ends of the 95 % interval are taken; it stops
// when twice the standard deviation of the average of each over the h blocks is within the
// numerical tolerance delta = 10^l / 2, where u = c * 10^l and c has the wanted number of digits.
// The figures returned are then taken from all h M draws together.
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
// Failure: NumericalError when an output is not finite (which draw, which output). What the model
// throws passes through. Not settling within max_blocks is no failure: `stabilised` says it.
// Validity: the interval is the probabilistically symmetric one, not the shortest. Memory: 8 bytes
// for each draw and output. For one output and a linear model GUM first order costs nothing and
// says the same.
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
  double low = 0.0;  // the interval that holds `probability` and leaves as much on either side
  double high = 0.0;
  double tolerance = 0.0;  // delta; the figures above are good to about this much when settled
};

struct MonteCarloResult {
  bool stabilised = false;
  std::uint64_t draws = 0;
  std::vector<MonteCarloOutput> outputs;
};

using MonteCarloModel = std::function<void(std::uint64_t draw, std::span<double> outputs)>;

MonteCarloResult PropagateDistributions(std::size_t output_count, const MonteCarloModel& model,
                                        const MonteCarloOptions& options = {});

// The figures of one sample (JCGM 101, 7.6 and 7.7.2); it is reordered. `tolerance` stays 0.
MonteCarloOutput SummariseDraws(std::span<double> draws, double probability = 0.95);

}  // namespace abbe::estimation
