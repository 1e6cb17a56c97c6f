#include <fmt/format.h>

#include <cmath>

#include "compensation/nc_cycles.h"
#include "compensation/nc_moves.h"

namespace abbe::compensation {

using Eigen::Vector3d;

NcCycle NcMoves::CycleOf(const NcMeaning& meaning) {
  const auto [u, v, w] = AxesOfPlane(state_.plane);
  NcCycle cycle;
  cycle.code = state_.motion / 10;
  cycle.plane = state_.plane;
  cycle.retracts_to_r = state_.retracts_to_r;
  const auto keep = [](const NcMeaning::Value& given, double& kept, double times = 1.0) {
    if (given) kept = times * *given;
    return kept;
  };
  const double unit = state_.Unit(), half = state_.is_diameter ? 0.5 : 1.0;
  const auto factor = [&](int k) { return k == 0 ? half : 1.0; };
  cycle.r = keep(meaning.radius, state_.cycle_r);
  cycle.bottom = keep(meaning.axes[w], state_.cycle_bottom, factor(w));
  cycle.peck = keep(meaning.q, state_.cycle_peck);
  cycle.dwell = keep(meaning.p, state_.cycle_dwell);
  if (std::isnan(cycle.r)) Refuse("the cycle has no R");
  if (std::isnan(cycle.bottom)) Refuse(fmt::format("the cycle has no {}", "XYZ"[w]));
  const bool dwells = cycle.code == 82 || cycle.code == 86 || cycle.code == 89;
  if (dwells && std::isnan(cycle.dwell)) Refuse("the cycle has no P");
  if (std::isnan(state_.cycle_initial)) state_.cycle_initial = state_.place[w] / unit;
  cycle.initial = state_.cycle_initial;
  if (state_.is_relative) cycle.r += cycle.initial;  // counted from there; the bottom from R
  if (state_.is_relative) cycle.bottom += cycle.r;
  if (state_.is_inch) cycle.gap = 0.010;
  const double holes = meaning.l.value_or(1.0);
  if (!(holes >= 1.0 && holes <= kMostLines) || holes != std::round(holes)) {
    Refuse(fmt::format("L {:.9g} is no number of holes from 1 to {:.0e}", holes, kMostLines));
  }
  const Vector3d before = state_.place;
  for (double i = 0.0; i < holes; ++i) {
    const Vector3d to = Target(meaning);
    state_.place[u] = to[u];
    state_.place[v] = to[v];
    // As written where it is: without rounding by the unit.
    const auto where = [&](int k) {
      if (meaning.axes[k] && !state_.is_relative) return factor(k) * *meaning.axes[k];
      return to[k] / unit;
    };
    cycle.holes.emplace_back(where(u), where(v));
  }
  state_.place = before;
  return cycle;
}

void NcMoves::WriteCycle(const NcBlock& block, const NcMeaning& meaning) {
  const NcCycle cycle = CycleOf(meaning);
  const double unit = state_.Unit();
  if (cycle.code == 86) {
    const auto spindle = state_.words.find(NcGroup::kSpindle);
    if (spindle == state_.words.end() || spindle->second == "M5") {
      Refuse("G86 stops the spindle and starts it again, but it does not turn; set M3 or M4");
    }
  }
  WriteWords(block);
  bool is_first = true;
  for (const NcCycleStep& step : StepsOf(cycle, state_.place / unit, line_number_)) {
    if (!is_first) writer_.EndLine();
    is_first = false;
    switch (step.step) {
      case NcStep::kDwell:
        writer_.Word(fmt::format("G4 P{:.6g}", cycle.dwell));
        continue;
      case NcStep::kSpindleStop:
        writer_.Word("M5");
        continue;
      case NcStep::kSpindleStart:
        writer_.Word(state_.words.at(NcGroup::kSpindle));
        continue;
      default:
        break;
    }
    const Vector3d to = unit * step.to;
    points_.clear();
    if (step.step == NcStep::kRapid) {
      points_.push_back(to);
    } else {
      MustReach(to);
      AddLine(state_.place, to, options_.limits, line_number_, points_);
    }
    WritePath(step.step == NcStep::kRapid ? 0 : 10);
    state_.place = to;
  }
}

}  // namespace abbe::compensation
