// Many 32-bit words of a counter-based stream at once.
//
// Word j of stream (seed, stream) is CounterRandom(seed, stream).Bits(j / 4)[j % 4]; the words are
// the same ones, computed for several counters side by side so that the compiler can use vector
// instructions. Generator: Philox 4x32-10 (Salmon, Moraes, Dror, Shaw, SC 2011, section 3.3).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace abbe::random {

inline constexpr std::size_t kCountersAtOnce = 8;
inline constexpr std::size_t kWordsAtOnce = 4 * kCountersAtOnce;

// Fills `words`, whose size is a multiple of kWordsAtOnce, with the words from
// 4 * first_counter on.
inline void FillWords(std::uint64_t seed, std::uint64_t stream, std::uint64_t first_counter,
                      std::span<std::uint32_t> words) {
  using Lanes = std::array<std::uint32_t, kCountersAtOnce>;
  for (std::size_t at = 0; at < words.size(); at += kWordsAtOnce) {
    Lanes c0, c1, c2, c3;
    for (std::size_t i = 0; i < kCountersAtOnce; ++i) {
      const std::uint64_t counter = first_counter + at / 4 + i;
      c0[i] = static_cast<std::uint32_t>(counter);
      c1[i] = static_cast<std::uint32_t>(counter >> 32);
      c2[i] = static_cast<std::uint32_t>(stream);
      c3[i] = static_cast<std::uint32_t>(stream >> 32);
    }
    std::uint32_t k0 = static_cast<std::uint32_t>(seed);
    std::uint32_t k1 = static_cast<std::uint32_t>(seed >> 32);
    for (int round = 0; round < 10; ++round) {
      for (std::size_t i = 0; i < kCountersAtOnce; ++i) {
        const std::uint64_t p0 = std::uint64_t{0xD2511F53} * c0[i];
        const std::uint64_t p1 = std::uint64_t{0xCD9E8D57} * c2[i];
        c0[i] = static_cast<std::uint32_t>(p1 >> 32) ^ c1[i] ^ k0;
        c2[i] = static_cast<std::uint32_t>(p0 >> 32) ^ c3[i] ^ k1;
        c1[i] = static_cast<std::uint32_t>(p1);
        c3[i] = static_cast<std::uint32_t>(p0);
      }
      k0 += 0x9E3779B9;
      k1 += 0xBB67AE85;
    }
    for (std::size_t i = 0; i < kCountersAtOnce; ++i) {
      words[at + 4 * i] = c0[i];
      words[at + 4 * i + 1] = c1[i];
      words[at + 4 * i + 2] = c2[i];
      words[at + 4 * i + 3] = c3[i];
    }
  }
}

}  // namespace abbe::random
