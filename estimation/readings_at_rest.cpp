#include "estimation/readings_at_rest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

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

// A sine on white noise.
struct Sine {
  double frequency = 0.0, gain = 0.0, sd = 0.0;
};

VectorXd AboutMeans(const std::vector<Stay>& stays, const VectorXd& values) {
  VectorXd about = values;
  Index first = 0;
  for (const Stay& stay : stays) {
    auto own = about.segment(first, stay.value.size());
    own.array() -= own.mean();
    first += stay.value.size();
  }
  return about;
}

double SpanOf(const std::vector<Stay>& stays) {
  const VectorXd &first = stays.front().time, &last = stays.back().time;
  return last[last.size() - 1] - first[0];
}

constexpr double kOfAWave = 0.4;  // over all readings, from one frequency to the next

// Those that even readings tell apart.
std::vector<double> FrequenciesUpTo(double highest, double span) {
  constexpr double kMost = 20000.0;
  const double apart = std::max(kOfAWave / span, highest / kMost);
  std::vector<double> frequencies;
  for (double each = apart; each <= highest; each += apart) frequencies.push_back(each);
  return frequencies;
}

// Where the readings are not quite even a line beyond them has no alias among them.
std::vector<double> FrequenciesOfMains(double span) {
  constexpr double kOff = 0.1, kClose = 0.25;  // Hz; of the step: an alias differs by little
  std::vector<double> frequencies;
  for (const double mains : kMains) {
    for (double off = -kOff; off <= kOff; off += kClose * kOfAWave / span)
      frequencies.push_back(mains + off);
  }
  return frequencies;
}

Sine StrongestSine(const std::vector<Stay>& stays, const std::vector<double>& frequencies) {
  Index count = 0;
  for (const Stay& stay : stays) count += stay.value.size();
  VectorXd time(count), value(count);
  Index first = 0;
  for (const Stay& stay : stays) {
    time.segment(first, stay.time.size()) = stay.time;
    value.segment(first, stay.value.size()) = stay.value;
    first += stay.value.size();
  }
  value = AboutMeans(stays, value);
  time.array() -= time[0];
  const double freedom = count - static_cast<double>(stays.size());
  const double squares = value.squaredNorm();
  Sine best;
  double most = 0.0;
  for (const double frequency : frequencies) {
    const VectorXd phase = 2.0 * std::numbers::pi * frequency * time;
    const VectorXd sine = AboutMeans(stays, phase.array().sin());
    const VectorXd cosine = AboutMeans(stays, phase.array().cos());
    Eigen::Matrix2d information;
    information << sine.squaredNorm(), sine.dot(cosine), sine.dot(cosine), cosine.squaredNorm();
    if (information.determinant() < 1e-6 * freedom * freedom) continue;
    const Eigen::Vector2d score(sine.dot(value), cosine.dot(value));
    const double explained = score.dot(information.inverse() * score);
    if (explained <= most) continue;
    most = explained;
    best.frequency = frequency;
  }
  if (most == 0.0 || freedom <= 3.0) return best;
  best.sd = std::sqrt(std::max(0.0, squares - most) / (freedom - 2.0));
  best.gain = -0.5 * freedom * std::log1p(-std::min(most / squares, 1.0 - 1e-12)) -
              std::log(static_cast<double>(frequencies.size()));
  return best;
}

}  // namespace

RestNoise NoiseAtRest(const std::vector<Stay>& stays) {
  constexpr Index kManyForMemory = 1500;
  constexpr double kShown = 8.0;  // logarithm of the likelihood
  constexpr double kNoNoise = 1e-3;
  const Differences next = DifferencesAt(stays, 1);
  RestNoise noise;
  if (next.pairs == 0.0) return noise;
  noise.sd = std::sqrt(next.variance);
  noise.freedom = 2.0 / 3.0 * next.pairs;
  noise.scatter = ScatterOf(stays);
  const std::vector<Stay> first = First(stays, kFewForLines);
  if (!(next.variance > 0.0) || first.empty() || !(SpanOf(first) > 0.0)) return noise;
  Sine sine = StrongestSine(first, FrequenciesOfMains(SpanOf(first)));
  MemoryFit memory;
  if (!IsWhite(stays, next)) {
    memory = FitMemory(first);
    if (!(memory.step > 0.0)) return noise;
    const Sine slow = StrongestSine(first, FrequenciesUpTo(0.5 / memory.step, SpanOf(first)));
    if (slow.gain > sine.gain) sine = slow;
  }
  if (std::max(sine.gain, memory.gain) < kShown || sine.sd < kNoNoise * noise.scatter) return noise;
  if (sine.gain > memory.gain) {
    noise.freedom = std::min<double>(noise.freedom, kFewForLines);
    noise.kind = RestKind::kLine;
    noise.frequency = sine.frequency;
    noise.sd = sine.sd;
  } else {
    memory = FitMemory(First(stays, kManyForMemory));
    noise.kind = RestKind::kMemory;
    noise.memory = memory.noise;
    noise.sd = memory.noise.sd();
    // A memory of so many readings leaves fewer that are independent.
    noise.freedom =
        std::min<double>(noise.freedom, kManyForMemory) * memory.noise.Independent(memory.step);
  }
  return noise;
}

}  // namespace abbe::estimation
