#include "estimation/reading_step.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace abbe::estimation {

void ReadingStep::Add(double reading) {
  constexpr std::size_t kEnough = 3000;
  if (different_.size() < kEnough) different_.insert(reading);
}

double ReadingStep::Step() const {
  constexpr std::size_t kFewest = 4;
  constexpr double kOff = 0.1;  // steps, from a whole multiple
  if (different_.size() < kFewest) return 0.0;
  const std::vector<double> readings(different_.begin(), different_.end());
  double step = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < readings.size(); ++i) {
    step = std::min(step, readings[i] - readings[i - 1]);
  }
  // The further apart two readings are, the better they tell the step.
  for (const double reading : readings) {
    const double apart = reading - readings.front(), steps = std::round(apart / step);
    if (std::abs(apart - steps * step) > kOff * step) return 0.0;
    if (steps > 0.0) step = apart / steps;
  }
  return step;
}

double ReadingStep::Unseen(double step, double variance) {
  if (!(step > 0.0)) return 0.0;
  const double rounding = step * step / 12.0, noise = std::max(0.0, variance - rounding);
  return rounding * std::exp(-4.0 * std::numbers::pi * std::numbers::pi * noise / (step * step));
}

}  // namespace abbe::estimation
