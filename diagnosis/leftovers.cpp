#include "diagnosis/leftovers.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "diagnosis/structure_refinement.h"

namespace abbe::diagnosis {
namespace {

// The explained part, over the rows of a shaft. Where it turns evenly, time and the harmonics that
// are known go together, and the coefficients of the answer are larger than what they do.
double RmsOf(const Fit& fit, const Found& found) {
  double weight = 0.0;
  for (std::size_t run = 0; run < fit.runs(); ++run) {
    if (InstrumentOf(fit.TraceOf(run)) != kFeltAtRim) continue;
    weight += fit.ScoresOf(run, found.structure.channel.stage).weights.sum();
  }
  return std::sqrt(found.chi_square / weight);
}

}  // namespace

void AddAlike(const Structure& other, Found& found) {
  const Dependence own{found.structure.variable, found.structure.channel.object},
      more{other.variable, other.channel.object};
  const bool known = std::ranges::find(found.one_of, more) != found.one_of.end();
  if (more != own && !known) found.one_of.push_back(more);
}

Leftover LeftoverOf(const Fit& fit, const Found& found, std::size_t questions) {
  const Structure& structure = found.structure;
  const double amplitude = structure.channel.instruments == kFeltAtRim ? RmsOf(fit, found)
                           : structure.interval.IsEmpty() ? found.length / std::numbers::sqrt2
                                                          : found.length;
  return {structure.variable,
          structure.channel.object,
          amplitude,
          structure.channel.unit,
          std::min(1.0, std::exp(found.log_probability) * questions),
          structure.wave > 0.0 ? 2.0 * std::numbers::pi / structure.wave : 0.0,
          structure.interval.from,
          structure.interval.to,
          found.one_of};
}

std::vector<Leftover> LeftoversOf(const Fit& fit, const std::vector<Found>& found) {
  constexpr std::size_t kMostTold = 6;  // what one stage does, the others see too
  std::vector<Leftover> leftovers;
  for (const Found& each : found) {
    const auto same = [&](const Leftover& other) {
      return other.object == each.structure.channel.object;
    };
    if (std::any_of(leftovers.begin(), leftovers.end(), same)) continue;
    if (LeftoverOf(fit, each, found.size()).p_value >= kDoubt) break;
    if (leftovers.size() == kMostTold) break;
    const bool interval = each.structure.form == Structure::Form::kInterval;
    Found strongest = interval ? Sharpened(fit, each) : each;
    for (const Found& other : found) {
      const bool alike = other.structure.channel.object == each.structure.channel.object &&
                         other.log_probability < strongest.log_probability + kAsGood;
      if (alike) AddAlike(other.structure, strongest);
    }
    leftovers.push_back(LeftoverOf(fit, strongest, found.size()));
  }
  return leftovers;
}

}  // namespace abbe::diagnosis
