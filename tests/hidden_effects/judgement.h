// Judging what the diagnosis says of the demonstration machine's worlds, and printing it.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <string>

#include "rig/campaign.h"
#include "study/hidden/judgement.h"
#include "tests/hidden_effects/hidden_world.h"

namespace abbe {

using diagnosis::Diagnosis;
using diagnosis::Finding;
using diagnosis::Verdict;
using study::AddSizes;
using study::LivesIn;
using study::NameOf;
using study::Names;
using study::Rate;

// One world in one line.
inline void Print(std::uint64_t seed, const rig::Campaign& world, const Diagnosis& diagnosis) {
  std::string line = fmt::format("{}", seed);
  for (const auto& effect : rig::TruthOf(world.hidden)) line += fmt::format(" {}", effect.dump());
  line += fmt::format(" -> {}, chi2 {:.3f} {:.3f}", Name(diagnosis.verdict), diagnosis.chi_before,
                      diagnosis.chi_after);
  for (const Finding& finding : diagnosis.findings) {
    const auto keys = KeysOf(finding.score);
    line += fmt::format("; {} p={:.3f}", finding.score.candidate.Name(), finding.probability);
    for (Eigen::Index i = 0; i < keys.values.size(); ++i) {
      const auto& key = finding.score.candidate.cause->keys[i];
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
