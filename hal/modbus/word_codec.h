// Numbers in 16-bit registers: words to number and number to words, by shifts only.
//
// A register holds two bytes, the high one first on the wire. A 32-bit number takes two registers,
// and makers disagree about the order of its four bytes A (most significant) to D. `order` names
// the bytes in their order on the wire: ABCD is high word first, CDAB low word first, BADC and DCBA
// the same with the bytes of each word swapped. For a 16-bit number BADC and DCBA swap its two
// bytes.
//
// Numbers here are raw: scale and offset belong to the channel (modbus_settings.h).
// Units: raw numbers.
// Failure: none; see the preconditions.
// Source: Modbus application protocol V1.1b3, 4.2, for the order of bytes in a word; IEEE 754 for
// float32.
#pragma once

#include <cstdint>
#include <span>

namespace abbe::hal {

enum class WordType { kInt16, kUint16, kInt32, kUint32, kFloat32 };
enum class WordOrder { kABCD, kCDAB, kBADC, kDCBA };

// Registers that a number of this type takes: 1 or 2.
std::size_t WordCount(WordType type);

// The number in words[0] (and words[1]); every integer is exact, a float32 may be NaN or infinite.
// Precondition: words.size() >= WordCount(type).
double NumberOf(std::span<const std::uint16_t> words, WordType type, WordOrder order);

// Stores `number` in words[0] (and words[1]), so that NumberOf() gives it back. An integer type
// rounds to the nearest and stops at the ends of its range, as a converter does; NaN is stored as 0
// there. Precondition: words.size() >= WordCount(type).
void StoreNumber(double number, WordType type, WordOrder order, std::span<std::uint16_t> words);

}  // namespace abbe::hal
