// Judging what the diagnosis says of worlds.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <string_view>

#include "tests/hidden_effects/hidden_world.h"

namespace abbe {

using diagnosis::Diagnosis;
using diagnosis::Finding;
using diagnosis::Verdict;

// A rate is met when its 99 % binomial interval does not contradict what was asked for.
struct Rate {
  int worlds = 0, met = 0;

  void Add(bool is_met) {
    ++worlds;
    met += is_met ? 1 : 0;
  }
  // The lower end of the interval.
  double Low() const {
    return met == 0
               ? 0.0
               : boost::math::binomial_distribution<>::find_lower_bound_on_p(worlds, met, 0.005);
  }
  // The upper end.
  double High() const {
    return met == worlds
               ? 1.0
               : boost::math::binomial_distribution<>::find_upper_bound_on_p(worlds, met, 0.005);
  }
  void Add(const Rate& other) {
    worlds += other.worlds;
    met += other.met;
  }
  std::string Text() const { return fmt::format("{} of {}", met, worlds); }
};

// Whether a finding is this effect; a thermal cause names its sensor behind the axis.
inline bool Names(const Finding& finding, const rig::HiddenEffect& effect) {
  const auto& candidate = finding.score.candidate;
  return candidate.cause->id == effect.entry->name &&
         candidate.object.name().starts_with(effect.object);
}

inline std::string NameOf(const rig::HiddenEffect& effect) {
  return fmt::format("{}:{}", effect.entry->name, effect.object);
}

// Counts which sizes of what is hidden lie inside their U95.
inline void AddSizes(const Finding& finding, const rig::HiddenEffect& truth, Rate& inside) {
  const auto keys = KeysOf(finding.score);
  for (Eigen::Index i = 0; i < keys.values.size(); ++i) {
    if (!(keys.u[i] > 0.0)) continue;  // counted, not estimated
    const std::string& name = finding.score.candidate.cause->keys[static_cast<std::size_t>(i)].name;
    const auto known = truth.values.find(name);
    if (known == truth.values.end()) continue;
    double off = keys.values[i] - truth.At(name);
    if (name == "phase_rad") off = std::remainder(off, 2.0 * std::numbers::pi);
    inside.Add(std::abs(off) <= 2.0 * keys.u[i]);
  }
}

// Whether something that is left depends on this, or one of these does: a column of the
// recordings, or the sum of two.
inline bool LivesIn(const Diagnosis& diagnosis, std::string columns) {
  const bool sensor = columns.ends_with("_c");
  for (const char* unit : {"_mm_min", "_mm", "_rad", "_s"}) {
    if (sensor) break;
    for (auto at = columns.find(unit); at != std::string::npos; at = columns.find(unit)) {
      columns.erase(at, std::string_view(unit).size());
    }
  }
  for (const auto& leftover : diagnosis.leftovers) {
    const auto named = [&](const auto& other) { return other.variable == columns; };
    if (named(leftover) || std::ranges::any_of(leftover.one_of, named)) return true;
  }
  return false;
}

// One world in one line, for whoever looks for what went wrong.
inline void Print(std::uint64_t seed, const rig::Campaign& world, const Diagnosis& diagnosis) {
  std::string line = fmt::format("{}", seed);
  for (const auto& effect : rig::TruthOf(world.hidden)) line += fmt::format(" {}", effect.dump());
  line += fmt::format(" -> {}, chi2 {:.3f} {:.3f}", Name(diagnosis.verdict), diagnosis.chi_before,
                      diagnosis.chi_after);
  for (const Finding& finding : diagnosis.findings) {
    const auto keys = KeysOf(finding.score);
    line += fmt::format("; {} p={:.3f}", finding.score.candidate.Name(), finding.probability);
    for (Eigen::Index i = 0; i < keys.values.size(); ++i) {
      const auto& key = finding.score.candidate.cause->keys[static_cast<std::size_t>(i)];
      line += fmt::format(" {}={:.4g}+-{:.2g}", key.name, keys.values[i] / key.unit,
                          2.0 * keys.u[i] / key.unit);
    }
  }
  for (const auto& leftover : diagnosis.leftovers) {
    line += fmt::format("; left {} of {} p={:.1g}", leftover.variable, leftover.object,
                        leftover.p_value);
    for (const auto& other : leftover.one_of) line += fmt::format(" or {}", other.variable);
  }
  fmt::print("{}\n", line);
  std::fflush(stdout);
}

inline Diagnosis DiagnosisOf(const HiddenWorlds& worlds, std::uint64_t seed,
                             const rig::Campaign& world) {
  const Diagnosis diagnosis = diagnosis::Diagnose(worlds.Recordings(world));
  Print(seed, world, diagnosis);
  return diagnosis;
}

}  // namespace abbe
