#include "standards/positioning.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "failure/failure.h"

namespace abbe::standards {
namespace {

void Check(const std::vector<TargetDeviations>& targets) {
  if (targets.empty())
    throw InputError("ISO 230-2: no target: give the deviations of at least one target");
  const std::size_t cycles = targets.front().up.size();
  if (cycles < 2) {
    throw InputError(
        fmt::format("ISO 230-2: {} cycle at target {:g} mm upwards: measure at least two", cycles,
                    targets.front().target * 1e3));
  }
  for (const TargetDeviations& target : targets) {
    if (target.up.size() != cycles || target.down.size() != cycles) {
      throw InputError(
          fmt::format("ISO 230-2: target {:g} mm has {} cycles up and {} down, the first target "
                      "has {}: measure each "
                      "target equally often in both directions",
                      target.target * 1e3, target.up.size(), target.down.size(), cycles));
    }
    for (const auto* deviations : {&target.up, &target.down}) {
      for (const double deviation : *deviations) {
        if (std::isfinite(deviation) && std::isfinite(target.target)) continue;
        throw InputError(
            fmt::format("ISO 230-2: target {:g} mm has the deviation {}: give finite numbers",
                        target.target * 1e3, deviation));
      }
    }
  }
}

double Mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / values.size();
}

double StandardDeviation(const std::vector<double>& values, double mean) {
  double sum = 0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return std::sqrt(sum / (values.size() - 1));
}

TargetFigures Evaluate(const TargetDeviations& target) {
  TargetFigures figures{};
  figures.target = target.target;
  figures.mean_up = Mean(target.up);
  figures.mean_down = Mean(target.down);
  figures.mean = (figures.mean_up + figures.mean_down) / 2;
  figures.reversal = figures.mean_up - figures.mean_down;
  figures.std_up = StandardDeviation(target.up, figures.mean_up);
  figures.std_down = StandardDeviation(target.down, figures.mean_down);
  figures.repeatability_up = 4 * figures.std_up;
  figures.repeatability_down = 4 * figures.std_down;
  figures.repeatability =
      std::max({2 * figures.std_up + 2 * figures.std_down + std::abs(figures.reversal),
                figures.repeatability_up, figures.repeatability_down});
  return figures;
}

// The range, highest minus lowest, of the included values.
struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void Include(double value, double margin = 0.0) {
    low = std::min(low, value - margin);
    high = std::max(high, value + margin);
  }
  double Size() const { return high - low; }
};

}  // namespace

Positioning EvaluatePositioning(const std::vector<TargetDeviations>& targets) {
  Check(targets);
  Positioning result{};
  Range means, means_up, means_down, middles, bands, bands_up, bands_down;
  for (const TargetDeviations& target : targets) {
    const TargetFigures figures = Evaluate(target);
    const double up = figures.mean_up, down = figures.mean_down;
    means_up.Include(up);
    means_down.Include(down);
    means.Include(up);
    means.Include(down);
    middles.Include(figures.mean);
    bands_up.Include(up, 2 * figures.std_up);
    bands_down.Include(down, 2 * figures.std_down);
    bands.Include(up, 2 * figures.std_up);
    bands.Include(down, 2 * figures.std_down);
    result.repeatability = std::max(result.repeatability, figures.repeatability);
    result.repeatability_up = std::max(result.repeatability_up, figures.repeatability_up);
    result.repeatability_down = std::max(result.repeatability_down, figures.repeatability_down);
    result.reversal = std::max(result.reversal, std::abs(figures.reversal));
    result.mean_reversal += figures.reversal / targets.size();
    result.targets.push_back(figures);
  }
  result.accuracy = bands.Size();
  result.accuracy_up = bands_up.Size();
  result.accuracy_down = bands_down.Size();
  result.systematic = means.Size();
  result.systematic_up = means_up.Size();
  result.systematic_down = means_down.Size();
  result.mean_range = middles.Size();
  return result;
}

}  // namespace abbe::standards
