// From the recordings of one machine to what explains them: the whole of `abbe diagnose`.
//
//   const learned::Explanation found = learned::Explain(recordings, instruments, {.learn = true});
//   found.diagnosis.findings;
//   found.learning.terms;
//
// Recordings that do not belong together are refused; noise that they show counts; the causes are
// searched for (diagnosis/diagnose.h), the runs that would tell rivals apart named, rows held out,
// and where it is asked for what nothing explains is learned (learning.h).
// Units: SI. Shapes: as each part has it.
// Failure: InputError for recordings that contradict the machine file or each other; that of Fit.
// Source: docs/theory-diagnosis.md.
// Validity: that of diagnosis/diagnose.h.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/campaign.h"
#include "diagnosis/diagnose.h"
#include "diagnosis/hold_out.h"
#include "learned/learning.h"
#include "recording/recording.h"
#include "simulation/extended_model.h"
#include "simulation/instruments.h"
#include "simulation/learned/learned_term.h"

namespace abbe::learned {

struct ExplainOptions {
  bool learn = false;
  // Terms of other machines, which compete as named causes (carried.h).
  std::vector<std::shared_ptr<const simulation::LearnedCause>> carried = {};
};

struct Explanation {
  std::shared_ptr<diagnosis::Campaign> campaign;  // what `diagnosis` refers to
  diagnosis::Diagnosis diagnosis;
  Learning learning = {};  // empty where it was not asked for, or nothing is left
  diagnosis::HeldOutGain gain = {};
  std::optional<std::string> why_no_gain = {};  // where the rows do not suffice to hold some out

  // With the noise and the errors of the machine as the diagnosis found them.
  const diagnosis::Campaign& found() const { return diagnosis::CampaignOf(diagnosis, *campaign); }
  // How the recordings were taken, and what was found of their noise.
  std::vector<std::string> Notes() const;
};

// The causes and the terms that were found, as other commands take them.
simulation::ExtendedModel ModelOf(const Explanation& explanation);

Explanation Explain(const std::vector<recording::Recording>& recordings,
                    simulation::Instruments instruments, const ExplainOptions& options = {});

}  // namespace abbe::learned
