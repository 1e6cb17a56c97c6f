// Whether what the diagnosis says of a world is what the world hides.
// Units: SI. Failure: none. Validity: effects that have the names and keys of causes.
#pragma once

#include <string>

#include "diagnosis/diagnose.h"
#include "rig/hidden_effect.h"
#include "study/rate.h"

namespace abbe::study {

using diagnosis::Diagnosis;
using diagnosis::Finding;
using diagnosis::Verdict;

// Whether a finding is this effect; a thermal cause names its sensor behind the axis.
bool Names(const Finding& finding, const rig::HiddenEffect& effect);

// "backlash:X"
std::string NameOf(const rig::HiddenEffect& effect);

// Counts which sizes of what is hidden lie inside their U95.
void AddSizes(const Finding& finding, const rig::HiddenEffect& truth, Rate& inside);

// Whether something that is left depends on this, or one of these does: a column of the recordings,
// or the sum of two.
bool LivesIn(const Diagnosis& diagnosis, std::string columns);

}  // namespace abbe::study
