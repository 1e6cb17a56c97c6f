// What a diagnosis leaves unexplained, in words.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/unexplained.h"

namespace abbe::apps {

// "UNEXPLAINED: ...", a line for all that do the same, or one for `each`.
std::string LeftoversText(const std::vector<diagnosis::Leftover>& leftovers, bool each);

}  // namespace abbe::apps
