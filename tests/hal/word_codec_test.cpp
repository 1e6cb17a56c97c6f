// Byte patterns are written by hand from the IEEE 754 and two's complement definitions (and equal
// Python's struct.pack of the same numbers), never from the codec itself.
#include "hal/modbus/word_codec.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace abbe::hal {
namespace word_codec_test {

using enum WordOrder;
using enum WordType;
using Words = std::vector<std::uint16_t>;

struct Pattern {
  double number;
  WordType type;
  WordOrder order;
  Words words;
};

// 12.5f = 0x41480000; -2.0f = 0xC0000000; pi as float = 0x40490FDB (struct.pack('>f', math.pi)).
const std::vector<Pattern> kPatterns = {
    {12.5, kFloat32, kABCD, {0x4148, 0x0000}},
    {12.5, kFloat32, kCDAB, {0x0000, 0x4148}},
    {12.5, kFloat32, kBADC, {0x4841, 0x0000}},
    {12.5, kFloat32, kDCBA, {0x0000, 0x4841}},
    {-2.0, kFloat32, kABCD, {0xC000, 0x0000}},
    {3.1415927410125732, kFloat32, kABCD, {0x4049, 0x0FDB}},
    {3.1415927410125732, kFloat32, kCDAB, {0x0FDB, 0x4049}},
    {3.1415927410125732, kFloat32, kBADC, {0x4940, 0xDB0F}},
    {3.1415927410125732, kFloat32, kDCBA, {0xDB0F, 0x4940}},
    {305419896.0, kUint32, kABCD, {0x1234, 0x5678}},
    {305419896.0, kUint32, kCDAB, {0x5678, 0x1234}},
    {305419896.0, kUint32, kBADC, {0x3412, 0x7856}},
    {305419896.0, kUint32, kDCBA, {0x7856, 0x3412}},
    {4294967295.0, kUint32, kABCD, {0xFFFF, 0xFFFF}},
    {-1.0, kInt32, kABCD, {0xFFFF, 0xFFFF}},
    {-2.0, kInt32, kCDAB, {0xFFFE, 0xFFFF}},
    {-2147483648.0, kInt32, kABCD, {0x8000, 0x0000}},
    {2147483647.0, kInt32, kDCBA, {0xFFFF, 0xFF7F}},
    {65535.0, kUint16, kABCD, {0xFFFF}},
    {4660.0, kUint16, kCDAB, {0x1234}},
    {4660.0, kUint16, kBADC, {0x3412}},
    {-32768.0, kInt16, kABCD, {0x8000}},  // WAGO 750-456: -10 V
    {32760.0, kInt16, kABCD, {0x7FF8}},   // WAGO 750-456: +10 V
    {-2.0, kInt16, kDCBA, {0xFEFF}},
};

TEST(WordCodec, ReadsPatternsWrittenByHand) {
  for (const Pattern& pattern : kPatterns) {
    EXPECT_EQ(NumberOf(pattern.words, pattern.type, pattern.order), pattern.number);
  }
}

TEST(WordCodec, WritesPatternsWrittenByHand) {
  for (const Pattern& pattern : kPatterns) {
    Words words(WordCount(pattern.type));
    StoreNumber(pattern.number, pattern.type, pattern.order, words);
    EXPECT_EQ(words, pattern.words) << pattern.number;
  }
}

TEST(WordCodec, TakesOneRegisterFor16BitsAndTwoFor32) {
  EXPECT_EQ(WordCount(kInt16), 1u);
  EXPECT_EQ(WordCount(kUint16), 1u);
  EXPECT_EQ(WordCount(kInt32), 2u);
  EXPECT_EQ(WordCount(kUint32), 2u);
  EXPECT_EQ(WordCount(kFloat32), 2u);
}

TEST(WordCodec, EveryWordRoundTripsInEveryOrder) {
  for (const WordOrder order : {kABCD, kCDAB, kBADC, kDCBA}) {
    for (std::uint32_t pattern = 0; pattern < 0x10000; ++pattern) {
      const Words words{static_cast<std::uint16_t>(pattern)};
      for (const WordType type : {kInt16, kUint16}) {
        Words back(1);
        StoreNumber(NumberOf(words, type, order), type, order, back);
        ASSERT_EQ(back, words);
      }
      const Words pair{words[0], static_cast<std::uint16_t>(pattern * 40503)};
      for (const WordType type : {kInt32, kUint32}) {
        Words back(2);
        StoreNumber(NumberOf(pair, type, order), type, order, back);
        ASSERT_EQ(back, pair);
      }
    }
  }
}

TEST(WordCodec, StopsAtTheEndsOfAnIntegerAndRoundsToTheNearest) {
  const auto stored = [](double number, WordType type) {
    Words words(2);
    StoreNumber(number, type, kABCD, words);
    return NumberOf(words, type, kABCD);
  };
  EXPECT_EQ(stored(1e9, kInt16), 32767);
  EXPECT_EQ(stored(-1e9, kInt16), -32768);
  EXPECT_EQ(stored(-1.0, kUint16), 0);
  EXPECT_EQ(stored(1e12, kUint32), 4294967295.0);
  EXPECT_EQ(stored(-1e12, kInt32), -2147483648.0);
  EXPECT_EQ(stored(1.5, kUint16), 2);
  EXPECT_EQ(stored(-1.5, kInt16), -2);
  EXPECT_EQ(stored(std::numeric_limits<double>::quiet_NaN(), kInt32), 0);
}

TEST(WordCodec, KeepsFloatsThatAreNotNumbers) {
  EXPECT_TRUE(std::isnan(NumberOf(Words{0x7FC0, 0x0000}, kFloat32, kABCD)));
  EXPECT_EQ(NumberOf(Words{0x0000, 0xFF80}, kFloat32, kCDAB),
            -std::numeric_limits<double>::infinity());
}

}  // namespace word_codec_test
}  // namespace abbe::hal
