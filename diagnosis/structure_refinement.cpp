#include "diagnosis/structure_refinement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "simulation/variables.h"

namespace abbe::diagnosis {

using Eigen::Index;
using simulation::IsGap;

// The scan does not know what else may take in a part of an effect, and stops at an edge of it:
// moves the borders as long as more is explained.
Found Sharpened(const Fit& fit, Found found) {
  const Range range = found.structure.range;
  const double cell = range.Length() / kLines;
  const double end = std::nextafter(range.last, std::numeric_limits<double>::infinity());
  for (bool better = true; better;) {
    const auto [from, to] = found.structure.interval;
    std::vector<Structure> others;
    const auto add = [&](Interval interval) {
      interval.from = std::max(interval.from, range.first);
      interval.to = std::min(interval.to, end);
      if (interval.to - interval.from < 0.5 * cell) return;
      others.push_back(found.structure);
      others.back().interval = interval;
    };
    for (Index cells = 1; cells < kLines; cells *= 2) {
      const double step = cell * cells;
      add({from - step, to});
      add({from + step, to});
      add({from, to - step});
      add({from, to + step});
      add({from - step, from});
      add({to, to + step});
    }
    // On the way there and back the simulation sees differences: its mirror does nearly the same.
    add({from - (to - from), from});
    add({to, to + (to - from)});
    better = false;
    for (Found& other : StructureQuestions(fit).Ask(others)) {
      if (other.chi_square <= found.chi_square) continue;
      found = std::move(other);
      better = true;
    }
  }
  return found;
}

namespace {

// Where it turns evenly, tuned waves are the harmonics that causes make.
bool IsAtShaft(const Found& found) { return found.structure.channel.instruments == kFeltAtRim; }

// A smooth function with as many terms as the data ask for. What a probe makes of its own gap has
// no fine structure: along an axis the gap goes with the position, and many terms would do what two
// swapped cables do.
Found Finest(const Fit& fit, Found found) {
  constexpr Index kMostTerms = 64;
  const Index most = IsGap(found.structure.variable) ? found.structure.terms : kMostTerms;
  for (Index terms = 2 * found.structure.terms; terms <= most; terms *= 2) {
    std::vector<Structure> finer(2, found.structure);
    for (Structure& each : finer) each.terms = terms;
    finer.back().is_rough = true;
    bool better = false;
    for (Found& other : StructureQuestions(fit).Ask(finer)) {
      if (other.drawn.log_evidence <= found.drawn.log_evidence) continue;
      found = std::move(other);
      better = true;
    }
    if (!better) break;
  }
  return found;
}

// The wave between those that were tried, to a thousandth of the step between them.
Found Tuned(const Fit& fit, Found found) {
  constexpr int kLevels = 5, kTried = 4;  // on both sides
  double step = 2.0 * std::numbers::pi * kOfAWave / found.structure.range.Length() / kTried;
  for (int level = 0; level < kLevels; ++level, step /= kTried) {
    std::vector<Structure> others;
    for (int i = -kTried; i <= kTried; ++i) {
      const double wave = found.structure.wave + i * step;
      if (i == 0 || wave <= 0.0) continue;
      others.push_back(found.structure);
      others.back().wave = wave;
    }
    for (Found& other : StructureQuestions(fit).Ask(others)) {
      if (other.chi_square > found.chi_square) found = std::move(other);
    }
  }
  return found;
}

}  // namespace

Found Refined(const Fit& fit, Found found) {
  if (found.structure.form == Structure::Form::kInterval) return Sharpened(fit, std::move(found));
  if (found.structure.form == Structure::Form::kSmooth) return Finest(fit, std::move(found));
  if (found.structure.form == Structure::Form::kLine && !IsAtShaft(found)) {
    return Tuned(fit, std::move(found));
  }
  return found;
}

}  // namespace abbe::diagnosis
