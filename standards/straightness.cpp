#include "standards/straightness.h"

#include <algorithm>

namespace abbe::standards {

Straightness EvaluateStraightness(LineKind kind, std::span<const double> x,
                                  std::span<const double> y) {
  Straightness result{ReferenceLine(kind, x, y), {}, 0.0};
  double highest = 0.0, lowest = 0.0;
  result.deviations.reserve(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double deviation = y[i] - result.line.At(x[i]);
    result.deviations.push_back(deviation);
    highest = std::max(highest, deviation);
    lowest = std::min(lowest, deviation);
  }
  result.error = highest - lowest;
  return result;
}

}  // namespace abbe::standards
