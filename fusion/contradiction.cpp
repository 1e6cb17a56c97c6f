#include "fusion/contradiction.h"

#include <fmt/format.h>

#include <cmath>

#include "failure/failure.h"

namespace abbe::fusion {

constexpr double kContradiction = 6.0;  // prior standard deviations

void RefuseContradiction(const estimation::Result& fit, double excess) {
  for (const auto& block : fit.blocks) {
    for (std::size_t i = 0; i < block.entries.size(); ++i) {
      const auto& entry = block.entries[i];
      const double pull = (entry.value - entry.nominal) / entry.prior_sd;
      if (!(std::abs(pull) > kContradiction * excess)) continue;
      throw InputError(fmt::format(
          "calibration: {} comes out at {:.4g} {}, {:.1f} standard deviations from its nominal "
          "{:.4g}: the data contradict the prior; correct the nominal value or the tolerance in "
          "[linkage]",
          block.FullName(i), entry.value / block.unit.si, block.unit.name, pull,
          entry.nominal / block.unit.si));
    }
  }
}

}  // namespace abbe::fusion
