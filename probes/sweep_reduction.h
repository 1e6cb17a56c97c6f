// The reduction of an axis sweep: five error motions with uncertainty from a recording of five
// gaps.
//
//   const auto document = settings::Document::Read("machine.toml");
//   const SweepSetup setup = ReadSweepSetup(document.Root());
//   const SweepResult result = ReduceSweep(recording::Read("sweep_X.csv"), setup);
//
// Steps, one header each: sweep_dwells.h (rows -> dwells), sweep_stations.h (dwells -> station
// means), sweep_inversion.h (means -> errors), sweep_gauge.h, sweep_uncertainty.h. sweep_result.h
// describes the result, docs/sweep.md the use.
//
// Frames: M, at the axis reference and at the target (sweep_inversion.h).
// Units: SI. Shapes: one value per station (sweep_result.h).
// Failure: InputError for a recording of another kind, an impossible gap, fewer than three
// stations; NumericalError for readings that no small motion gives.
// Source: docs/theory-head.md for the errors, GUM (2008) for their uncertainty.
// Validity: a rigid target and head. Bending, and drift that is faster than the dwells follow each
// other, enter the uncertainty only through [noise] and [head.tolerance].
#pragma once

#include "machine/machine.h"
#include "probes/head_settings.h"
#include "probes/sweep_result.h"
#include "recording/recording.h"
#include "settings/document.h"

namespace abbe::probes {

struct SweepSetup {
  machine::Machine machine;
  HeadSettings head;
  TargetSettings target;
  ProbeNoise noise;
};

// InputError with file, line and key.
SweepSetup ReadSweepSetup(const settings::Table& root);

// All the steps, in one call.
SweepResult ReduceSweep(const recording::Recording& recording, const SweepSetup& setup);

}  // namespace abbe::probes
