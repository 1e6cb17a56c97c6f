// Which part of an uncertainty two measurements have in common. For use within history/.
#pragma once

#include <map>
#include <string>

#include "history/figure.h"

namespace abbe::history {

using Instruments = std::map<std::string, std::string>;  // "head" -> "P-12"

// Whether both state the same instrument. Of head, target and mounting the mounting must be stated
// and the same too, for another one turns their effects; the head is also the same where both state
// the same serial numbers.
bool IsShared(const std::string& role, const Instruments& one, const Instruments& other);

// The standard uncertainty of the difference of two values of standard uncertainties u and v with
// these shares: the parts of shared instruments are fully correlated and cancel, all else adds in
// squares.
double OfDifference(double u, const Shares& of_u, double v, const Shares& of_v,
                    const Instruments& one, const Instruments& other);

}  // namespace abbe::history
