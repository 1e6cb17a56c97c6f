// The study of hidden effects: how often the diagnosis is right about a reduced standard campaign
// of the virtual rig that hides nothing, an effect of the catalogue, two, or one of no catalogue.
//
// The seed draws machine, instruments, noise, effect and sizes; the diagnosis sees the machine file
// and the recordings only. A row has what was hidden, the verdict, the findings and what is left.
// Units: as rig and diagnosis state them in JSON; standard deviations for what can be seen.
// Failure: InputError for a machine file without probes or linkage.
// Source: the bounds are those of docs/results.md.
// Validity: variants of another machine than the file says need the lines of the demonstration
// machine.
#pragma once

#include "study/study.h"

namespace abbe::study {

extern const StudyKind kHiddenStudy;

}  // namespace abbe::study
