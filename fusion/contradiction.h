// Estimates that contradict what was known of them before.
#pragma once

#include "estimation/result.h"

namespace abbe::fusion {

// InputError naming the first estimate farther from its nominal value than six prior standard
// deviations, times `excess`, the factor of the residuals over their noise; [linkage] states both.
void RefuseContradiction(const estimation::Result& fit, double excess);

}  // namespace abbe::fusion
