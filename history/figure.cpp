#include "history/figure.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace abbe::history {

bool IsSigned(const std::string& quantity) {
  constexpr std::array<std::string_view, 9> kSigned{
      "urad",     "reversal_um", "reversal_urad", "positioning_reversal_um", "scale_ppm",
      "F_max_um", "F_min_um",    "D_um",          "length_error_um"};
  return std::ranges::find(kSigned, quantity) != kSigned.end();
}

}  // namespace abbe::history
