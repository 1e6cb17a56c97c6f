// What a diagnosis found, as an extended model for the other commands, with what it is not sure of:
// the verdict, the probability and the rivals of each cause, and what is left unexplained.
//
//   simulation::ExtendedModel model = FoundModel(diagnosis, campaign, gain);
//   model.sources = files;                                // which only the caller knows
//   recording::WholeFile file("mill.causes.toml");
//   file.Append(simulation::ExtendedModelText(model));
//   file.Finish();
//
// Rows that are no readings (stuck channels, outliers) are no part of a model.
// Units: SI.
// Failure: none.
// Source: docs/extended-model.md.
// Validity: that of the diagnosis; sizes are those of the fit with all findings.
#pragma once

#include <optional>

#include "diagnosis/diagnose.h"
#include "diagnosis/hold_out.h"
#include "simulation/extended_model.h"

namespace abbe::diagnosis {

// Values, U95 and covariance of one.
simulation::ModelledCause FoundCause(const Score& score);

// By how much what is left moves a measured point, m rms: a length as it is; an angle of a pivot
// times the reach of the linkage beyond that pivot; a scatter times the noise of a reading of its
// run, as if it did not average out. Empty where the noise of that run in space is not known.
std::optional<double> InSpace(const Leftover& leftover, const Campaign& campaign);

// All that are modelled; `gain` of hold_out.h.
simulation::ExtendedModel FoundModel(const Diagnosis& diagnosis, const Campaign& campaign,
                                     const HeldOutGain& gain);

}  // namespace abbe::diagnosis
