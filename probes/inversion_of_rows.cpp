#include "probes/inversion_of_rows.h"

#include <fmt/format.h>

#include <algorithm>

#include "failure/failure.h"
#include "failure/interruption.h"

namespace abbe::probes {

void InvertRows(const SmallAngleInversion& inversion, const Eigen::Ref<const ReadingRows>& readings,
                const Eigen::Ref<const Eigen::VectorXd>& d,
                const Eigen::Ref<const Eigen::VectorXd>& exx, Eigen::Ref<ErrorRows> errors) {
  constexpr Eigen::Index kAtOnce = 256;        // 22 KiB
  constexpr Eigen::Index kAsk = 32 * kAtOnce;  // a tenth of a millisecond
  const Eigen::Index n = readings.cols();
  if (d.size() != n || (exx.size() != 0 && exx.size() != n) || errors.cols() != n) {
    throw InputError(
        fmt::format("{} rows of readings with {} of travel, {} of EXX and {} of errors", n,
                    d.size(), exx.size(), errors.cols()));
  }
  const Eigen::VectorXd none;
  SmallAngleInversion::Readings turned;
  SmallAngleInversion::Errors found;
  for (Eigen::Index first = 0; first < n; first += kAtOnce) {
    if (first % kAsk == 0) MayBeInterrupted();
    const Eigen::Index count = std::min(kAtOnce, n - first);
    turned = readings.middleCols(first, count).transpose();
    if (exx.size() == 0) {
      inversion.Invert(turned, d.segment(first, count), none, found);
    } else {
      inversion.Invert(turned, d.segment(first, count), exx.segment(first, count), found);
    }
    errors.middleCols(first, count) = found.transpose();
  }
}

}  // namespace abbe::probes
