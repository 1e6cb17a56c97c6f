// Random numbers that are a pure function of (seed, stream, index).
//
// Nothing is stored between draws, so a result does not depend on the order of the draws, on the
// number of threads or on the number of ranks: draw number 17 of stream 3 under seed 5 is always
// the same number. Generator: Philox 4x32-10 (Salmon, Moraes, Dror, Shaw, SC 2011), by Random123.
//
//   const CounterRandom noise(seed, kNoiseStream);
//   const double reading = truth + sigma * noise.Normal(sample_number);
#pragma once

#include <Random123/philox.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace abbe::random {

class CounterRandom {
 public:
  CounterRandom(std::uint64_t seed, std::uint64_t stream) : seed_(seed), stream_(stream) {}

  // Four independent 32-bit words of draw `index`.
  std::array<std::uint32_t, 4> Bits(std::uint64_t index) const {
    // The stream is folded into the upper counter words, the seed is the key.
    const r123::Philox4x32::ctr_type counter{
        {static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(index >> 32),
         static_cast<std::uint32_t>(stream_), static_cast<std::uint32_t>(stream_ >> 32)}};
    const r123::Philox4x32::key_type key{
        {static_cast<std::uint32_t>(seed_), static_cast<std::uint32_t>(seed_ >> 32)}};
    const auto words = r123::Philox4x32{}(counter, key);
    return {words[0], words[1], words[2], words[3]};
  }

  // Uniform in the open interval (0, 1), 53 bits.
  double Uniform(std::uint64_t index) const { return Unit(Bits(index), 0); }

  // Uniform in (low, high).
  double Uniform(std::uint64_t index, double low, double high) const {
    return low + (high - low) * Uniform(index);
  }

  // Two independent uniforms of one draw.
  std::array<double, 2> UniformPair(std::uint64_t index) const {
    const auto words = Bits(index);
    return {Unit(words, 0), Unit(words, 2)};
  }

  // Standard normal (Box-Muller).
  double Normal(std::uint64_t index) const {
    const auto [u, v] = UniformPair(index);
    return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
  }

 private:
  static double Unit(const std::array<std::uint32_t, 4>& words, std::size_t at) {
    const std::uint64_t high = words[at] >> 5;     // 27 bits
    const std::uint64_t low = words[at + 1] >> 6;  // 26 bits
    return (((high << 26) | low) + 0.5) * 0x1.0p-53;
  }

  std::uint64_t seed_;
  std::uint64_t stream_;
};

}  // namespace abbe::random
