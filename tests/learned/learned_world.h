// What is learned of a world of the virtual rig, in a few lines.
#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "learned/learning.h"
#include "learned/words.h"
#include "tests/hidden_effects/judgement.h"

namespace abbe {

struct LearnedWorld {
  Diagnosis diagnosis;
  learned::Learning learning;
};

inline LearnedWorld LearnedFrom(const HiddenWorlds& worlds, std::uint64_t seed,
                                const rig::Campaign& world) {
  const diagnosis::Campaign campaign = worlds.Recordings(world);
  LearnedWorld known{diagnosis::Diagnose(campaign), {}};
  Print(seed, world, known.diagnosis);
  known.learning = learned::Learn(known.diagnosis);
  if (known.learning.terms.empty()) return known;
  diagnosis::HeldOutGain gain;
  if (known.learning.IsToBeDecided()) {
    gain = diagnosis::HoldOut(campaign, world.recordings, known.learning.Candidates());
  }
  learned::Decide(gain, known.learning, known.diagnosis);
  for (const auto& learned : known.learning.terms) {
    const auto& why = learned.term().certificate;
    fmt::print(
        "   {} {} [{}]: {}; chance {:.1g}, regime {}, imitated {:.2f}, {} {:.2f}, held out "
        "{:.3f} {:.3f}",
        learned.IsFound() ? "learned" : "not found", learned.term().object,
        learned.term().expression.Text(), learned::InWords(learned.term()), why.by_chance,
        why.regime, why.imitated, why.nearest, why.cosine, why.heldout_before, why.heldout_after);
    for (const std::string& doubt : learned.doubts) fmt::print("; doubt: {}", doubt);
    fmt::print("\n");
  }
  fmt::print("   verdict {}, chi2 {:.3f}", Name(known.diagnosis.verdict), known.learning.chi_after);
  for (const auto& left : known.learning.left) {
    fmt::print("; left {} of {} p={:.1g}", left.variable, left.object, left.p_value);
  }
  fmt::print("\n");
  std::fflush(stdout);
  return known;
}

}  // namespace abbe
