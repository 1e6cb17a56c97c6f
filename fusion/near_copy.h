// Whether two recordings are one measurement that was given twice with small changes: other digits,
// times, header, a constant added, rows left out, a part of the other.
//
//   if (const auto shared = SharedNoise(one, other)) ...       // 1: the same noise throughout
//
// What a machine does it does again, and two true repetitions agree in it to the last wave; the
// noise is new each time. So only what cannot repeat is compared. At a standstill (kStill), rows
// are taken in groups of four, their means removed; of the directions that are left, over all
// channels together, those two thirds with the largest variance are dropped: settling, mains,
// vibrations and drifts, which have few directions, are among them. The share S of equal less
// unequal signs in the rest, rows of equal time after one start at the same places, is 0 for
// independent noise, with a standard deviation of 1 / sqrt(n). Two are copies where
//
//   S > 0.4   and   S sqrt(n) > 10   and   S > 2 max_k |S_k|,     n >= 200
//
// S_k with the rows of k groups later, k = 1 to 12: what repeats from stay to stay says nothing.
// The result is the correlation of normal numbers with such signs, sin(S pi / 2). Without stays, as
// on circles, plates or shafts, recordings are one only where all readings are the same but for a
// constant in each channel, and have at least kDifferent values.
// Units: those of the recordings. Shapes: none.
// Failure: InputError for a kind that is not known; recordings without the columns say nothing.
// Source: ours; the correlation by signs is Sheppard, Phil. Trans. R. Soc. A 192 (1899).
// Validity: copies altered by less than the noise itself.
#pragma once

#include <cstddef>
#include <optional>

#include "recording/recording.h"

namespace abbe::fusion {

inline constexpr double kStill = 5e-3;          // mm
inline constexpr std::size_t kDifferent = 100;  // values of all channels together

// Nothing: two measurements, as far as can be seen.
std::optional<double> SharedNoise(const recording::Recording& one,
                                  const recording::Recording& other);

}  // namespace abbe::fusion
