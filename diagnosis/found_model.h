// What a diagnosis found, as an extended model for the other commands.
//
//   simulation::ExtendedModel model = FoundModel(diagnosis, campaign, gain);
//   model.sources = files;                                // which only the caller knows
//   recording::WholeFile file("mill.causes.toml");
//   file.Append(simulation::ExtendedModelText(model));
//   file.Finish();
//
// Rows that are no readings (stuck channels, outliers) are no part of a model. Units: SI.
#pragma once

#include "diagnosis/diagnose.h"
#include "diagnosis/hold_out.h"
#include "simulation/extended_model.h"

namespace abbe::diagnosis {

simulation::ModelledCause FoundCause(const Score& score);

simulation::ExtendedModel FoundModel(const Diagnosis& diagnosis, const Campaign& campaign,
                                     const HeldOutGain& gain);

}  // namespace abbe::diagnosis
