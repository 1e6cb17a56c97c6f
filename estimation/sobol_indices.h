// Global sensitivity of a model to its inputs: Sobol's indices by Saltelli's scheme.
//
// first_i is the share of the output's variance that vanishes when input i is known, total_i the
// share that remains when all others are known. Their difference is the interaction of input i with
// others; without interactions the first indices add up to 1.
//
//   const SobolResult result = SobolIndices(3, 1,
//       [&](std::uint64_t draw, std::span<double> x) {
//         for (std::size_t i = 0; i < x.size(); ++i) {
//           x[i] = random::CounterRandom(seed, i).Uniform(draw);
//         }
//       },
//       [](std::span<const double> x, std::span<double> y) { y[0] = x[0] + x[1] * x[2]; });
//   result.inputs[0].first;
//
// `draw` must be a pure function of the draw's index that gives independent inputs; draws 2 n and 2
// n + 1 are the rows n of Saltelli's matrices A and B. A model of several outputs has the indices
// of their sum of variances (Gamboa, Janon, Klein, Lagnoux, 2014), so outputs must share a unit.
// Cost: draws x (inputs + 2) runs of the model, called from several threads at once. The result is
// the same to the last bit for any number of threads.
// Units: `variance` that of the outputs squared, summed over outputs. Shapes: one entry of `inputs`
// for each input.
// Failure: NumericalError when an output is not finite, no output varies or there are fewer than
// two draws. Exceptions of the model pass through.
// Source: first: Saltelli et al., Computer Physics Communications 181 (2010), table 2 (b); total:
// Jansen (1999), table 2 (f) there. Standard uncertainties: of a ratio of means, first order.
// Validity: independent inputs. An estimate may fall below 0 or above 1 by its uncertainty.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace abbe::estimation {

struct SobolIndex {
  double first = 0.0;
  double first_uncertainty = 0.0;  // standard uncertainty, of the finite number of draws
  double total = 0.0;
  double total_uncertainty = 0.0;
};

struct SobolResult {
  double variance = 0.0;  // summed over the outputs
  std::vector<SobolIndex> inputs;
};

// The sums of the scheme, draw by draw, for a model that is run elsewhere.
class SobolSums {
 public:
  // `centre`: of each output; any constant near the mean lowers the variance of the first indices.
  SobolSums(std::size_t input_count, std::vector<double> centre);

  // The outputs of one row of A and of B; with each input, those of A with this input from B.
  class Draw {
   public:
    void Add(std::size_t input, std::span<const double> f_ab);

   private:
    friend class SobolSums;
    SobolSums& sums_;
    std::span<const double> f_a_, f_b_;
    double d_;
    Draw(SobolSums& sums, std::span<const double> f_a, std::span<const double> f_b);
  };
  Draw Add(std::span<const double> f_a, std::span<const double> f_b) { return {*this, f_a, f_b}; }
  void Add(const SobolSums& other);

  // NumericalError when no output varies.
  SobolResult Result() const;

 private:
  // Over draws, of the numerator n of an index and of its denominator d, the variance.
  struct RatioSums {
    double n = 0, nn = 0, nd = 0;
    void Add(double numerator, double denominator);
    void Add(const RatioSums& other);
  };
  double Uncertainty(const RatioSums& sums) const;

  std::vector<double> centre_;
  std::uint64_t draws_ = 0;
  double d_ = 0, dd_ = 0;
  std::vector<RatioSums> first_, total_;
};

struct SobolOptions {
  std::uint64_t draws = 4096;
  int threads = 0;  // 0: all; never more than the machine has
};

using SobolDraw = std::function<void(std::uint64_t draw, std::span<double> inputs)>;
using SobolModel = std::function<void(std::span<const double> inputs, std::span<double> outputs)>;

// `input_count` inputs, `output_count` outputs of one unit.
SobolResult SobolIndices(std::size_t input_count, std::size_t output_count, const SobolDraw& draw,
                         const SobolModel& model, const SobolOptions& options = {});

}  // namespace abbe::estimation
