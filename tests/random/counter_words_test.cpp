#include "random/counter_words.h"

#include <gtest/gtest.h>

#include <vector>

#include "random/counter_random.h"
#include "tests/each_width.h"

namespace abbe::random {
namespace counter_words_test {

// CounterRandom takes its words from Random123; these are computed here.
TEST(CounterWords, AreThoseOfRandom123) {
  const std::uint64_t large = 0x123456789abcdef0;
  test::OnEachWidth([&] {
    std::vector<std::uint32_t> words(3 * kWordsAtOnce);
    for (const std::uint64_t first : {std::uint64_t{0}, std::uint64_t{0xfffffffa}, large}) {
      FillWords(large + 1, large + 2, first, words);
      const CounterRandom random(large + 1, large + 2);
      for (std::size_t j = 0; j < words.size(); ++j) {
        ASSERT_EQ(words[j], random.Bits(first + j / 4)[j % 4]) << first << ' ' << j;
      }
    }
  });
}

// The known answers that Random123 publishes for Philox 4x32-10 (its kat_vectors).
TEST(CounterWords, GiveThePublishedAnswers) {
  std::vector<std::uint32_t> words(kWordsAtOnce);
  FillWords(0, 0, 0, words);
  EXPECT_EQ(words[0], 0x6627e8d5u);
  EXPECT_EQ(words[1], 0xe169c58du);
  EXPECT_EQ(words[2], 0xbc57ac4cu);
  EXPECT_EQ(words[3], 0x9b00dbd8u);
  FillWords(~0ull, ~0ull, ~0ull, words);
  EXPECT_EQ(words[0], 0x408f276du);
  EXPECT_EQ(words[1], 0x41c83b0eu);
  EXPECT_EQ(words[2], 0xa20bc7c6u);
  EXPECT_EQ(words[3], 0x6d5451fdu);
}

}  // namespace counter_words_test
}  // namespace abbe::random
