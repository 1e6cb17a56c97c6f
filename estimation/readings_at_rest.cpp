#include "estimation/readings_at_rest.h"

#include <algorithm>
#include <cmath>

#include "estimation/sine_search.h"

namespace abbe::estimation {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Half of the mean square of the differences of readings `lag` apart.
struct Differences {
  double variance = 0.0, pairs = 0.0;
};

Differences DifferencesAt(const std::vector<Stay>& stays, Index lag) {
  constexpr double kNormal = 0.6745, kStandsOut = 6.0;
  std::vector<double> sizes;
  for (const Stay& stay : stays) {
    for (Index k = lag; k < stay.value.size(); ++k) {
      sizes.push_back(std::abs(stay.value[k] - stay.value[k - lag]));
    }
  }
  if (sizes.empty()) return {};
  const auto middle = sizes.begin() + (sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  const double most = kStandsOut * *middle / kNormal;
  double sum = 0.0, pairs = 0.0;
  for (const double size : sizes) {
    if (size > most && most > 0.0) continue;
    sum += 0.5 * size * size;
    pairs += 1.0;
  }
  return {sum / pairs, pairs};
}

bool IsWhite(const std::vector<Stay>& stays, const Differences& next) {
  constexpr double kCertain = 4.0, kEnough = 20.0;
  for (Index lag = 2; lag <= kLags; ++lag) {
    const Differences apart = DifferencesAt(stays, lag);
    if (apart.pairs < kEnough) continue;
    // The difference of two correlations that white noise makes by chance.
    const double doubt = kCertain * std::sqrt(2.0 / apart.pairs);
    if (std::abs(apart.variance / next.variance - 1.0) >
        doubt * std::max(1.0, apart.variance / next.variance))
      return false;
  }
  return true;
}

double ScatterOf(const std::vector<Stay>& stays) {
  double squares = 0.0, freedom = 0.0;
  for (const Stay& stay : stays) {
    squares += (stay.value.array() - stay.value.mean()).square().sum();
    freedom += stay.value.size() - 1;
  }
  return freedom > 0.0 ? std::sqrt(squares / freedom) : 0.0;
}

std::vector<Stay> First(const std::vector<Stay>& stays, Index most) {
  std::vector<Stay> first;
  for (const Stay& stay : stays) {
    const Index count = std::min(most, stay.value.size());
    if (count < 2) break;
    first.push_back({stay.time.head(count), stay.value.head(count)});
    most -= count;
  }
  return first;
}

// What is shown of readings about the means of their stays.
struct Shown {
  Sine sine;
  MemoryFit memory;
};

Shown ShownBy(const std::vector<Stay>& stays, bool is_white) {
  const double span = stays.back().time.tail<1>()[0] - stays.front().time[0];
  Shown shown{StrongestSine(stays, FrequenciesOfMains(span)), {}};
  if (is_white) return shown;
  shown.memory = FitMemory(stays);
  if (!(shown.memory.step > 0.0)) return {};
  const Sine slow = StrongestSine(stays, FrequenciesUpTo(0.5 / shown.memory.step, span));
  if (slow.gain > shown.sine.gain) shown.sine = slow;
  return shown;
}

}  // namespace

RestNoise NoiseAtRest(const std::vector<Stay>& stays) {
  constexpr Index kManyForMemory = 1500;
  constexpr double kShown = 8.0;  // logarithm of the likelihood
  constexpr double kNoNoise = 1e-3;
  constexpr int kMostLines = 4;
  const Differences next = DifferencesAt(stays, 1);
  RestNoise noise;
  if (next.pairs == 0.0) return noise;
  noise.sd = std::sqrt(next.variance);
  noise.freedom = 2.0 / 3.0 * next.pairs;
  noise.scatter = ScatterOf(stays);
  std::vector<Stay> left = First(stays, kFewForLines);
  if (!(next.variance > 0.0) || left.empty()) return noise;
  if (!(left.back().time.tail<1>()[0] > left.front().time[0])) return noise;
  for (int line = 0; line < kMostLines; ++line) {
    const bool is_white = line == 0 ? IsWhite(stays, next) : IsWhite(left, DifferencesAt(left, 1));
    const auto [sine, memory] = ShownBy(left, is_white);
    if (std::max(sine.gain, memory.gain) < kShown || sine.sd < kNoNoise * noise.scatter) break;
    if (sine.gain > memory.gain) {
      if (line == 0) noise.frequency = sine.frequency;
      noise.kind = RestKind::kLine;
      noise.freedom = std::min<double>(noise.freedom, kFewForLines);
      noise.sd = sine.sd;
      left = Without(sine, left);
      continue;
    }
    if (line > 0) break;
    const MemoryFit of_many = FitMemory(First(stays, kManyForMemory));
    noise.kind = RestKind::kMemory;
    noise.memory = of_many.noise;
    noise.sd = of_many.noise.sd();
    // A memory of so many readings leaves fewer that are independent.
    noise.freedom =
        std::min<double>(noise.freedom, kManyForMemory) * of_many.noise.Independent(of_many.step);
    break;
  }
  return noise;
}

}  // namespace abbe::estimation
