#include "hal/modbus/word_codec.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace abbe::hal {
namespace {

bool SwapsBytes(WordOrder order) { return order == WordOrder::kBADC || order == WordOrder::kDCBA; }
bool LowWordFirst(WordOrder order) {
  return order == WordOrder::kCDAB || order == WordOrder::kDCBA;
}

std::uint16_t Ordered(std::uint16_t word, WordOrder order) {
  return SwapsBytes(order) ? static_cast<std::uint16_t>((word >> 8) | (word << 8)) : word;
}

template <class Integer>
Integer Nearest(double number) {
  if (std::isnan(number)) return 0;
  constexpr double kLow = std::numeric_limits<Integer>::min();
  constexpr double kHigh = std::numeric_limits<Integer>::max();
  return static_cast<Integer>(std::round(std::clamp(number, kLow, kHigh)));
}

std::uint32_t Pattern(double number, WordType type) {
  switch (type) {
    case WordType::kInt16:
      return static_cast<std::uint16_t>(Nearest<std::int16_t>(number));
    case WordType::kUint16:
      return Nearest<std::uint16_t>(number);
    case WordType::kInt32:
      return Nearest<std::int32_t>(number);
    case WordType::kUint32:
      return Nearest<std::uint32_t>(number);
    case WordType::kFloat32:
      break;
  }
  return std::bit_cast<std::uint32_t>(static_cast<float>(number));
}

}  // namespace

std::size_t WordCount(WordType type) {
  return type == WordType::kInt16 || type == WordType::kUint16 ? 1 : 2;
}

double NumberOf(std::span<const std::uint16_t> words, WordType type, WordOrder order) {
  const std::uint16_t first = Ordered(words[0], order);
  if (type == WordType::kUint16) return first;
  if (type == WordType::kInt16) return static_cast<std::int16_t>(first);
  std::uint32_t high = first, low = Ordered(words[1], order);
  if (LowWordFirst(order)) std::swap(high, low);
  const std::uint32_t pattern = (high << 16) | low;
  if (type == WordType::kUint32) return pattern;
  if (type == WordType::kInt32) return static_cast<std::int32_t>(pattern);
  return std::bit_cast<float>(pattern);
}

void StoreNumber(double number, WordType type, WordOrder order, std::span<std::uint16_t> words) {
  const std::uint32_t pattern = Pattern(number, type);
  if (WordCount(type) == 1) {
    words[0] = Ordered(static_cast<std::uint16_t>(pattern), order);
    return;
  }
  auto high = static_cast<std::uint16_t>(pattern >> 16);
  auto low = static_cast<std::uint16_t>(pattern & 0xFFFF);
  if (LowWordFirst(order)) std::swap(high, low);
  words[0] = Ordered(high, order);
  words[1] = Ordered(low, order);
}

}  // namespace abbe::hal
