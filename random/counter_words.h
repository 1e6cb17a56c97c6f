// Many 32-bit words of a counter-based stream at once, with the vectors of the processor.
//
//   std::vector<std::uint32_t> words(256);
//   FillWords(seed, stream, first_counter, words);
//
// Word j of stream (seed, stream) is CounterRandom(seed, stream).Bits(j / 4)[j % 4], on each width of
// vectors. Generator: Philox 4x32-10 (Salmon, Moraes, Dror, Shaw, SC 2011, section 3.3).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace abbe::random {

inline constexpr std::size_t kWordsAtOnce = 32;

// Fills `words`, whose size is a multiple of kWordsAtOnce, with the words from
// 4 * first_counter on.
void FillWords(std::uint64_t seed, std::uint64_t stream, std::uint64_t first_counter,
               std::span<std::uint32_t> words);

}  // namespace abbe::random
