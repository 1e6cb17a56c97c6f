#include "track/first_order_lag.h"

#include <cmath>

namespace abbe::track {

double LagAfter(double lagged, double from, double to, double seconds, double lag) {
  if (!(lag > 0.0)) return to;
  if (!(seconds > 0.0)) return lagged;
  const double behind = (to - from) / seconds * lag;
  return to - behind + (lagged - from + behind) * std::exp(-seconds / lag);
}

}  // namespace abbe::track
