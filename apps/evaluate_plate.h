// What `abbe plate` does with its recordings.
// Frames, units, shapes: apps/plate_result.h.
// Failure: that of fusion::Fuse, fusion::CompareInterpolators and fusion::CheckSpecimen.
// Source: docs/plate.md. Validity: recordings of one machine.
#pragma once

#include <optional>
#include <vector>

#include "apps/plate_result.h"
#include "machine/machine.h"
#include "recording/recording.h"
#include "simulation/points/plate_simulation.h"

namespace abbe::apps {

struct PlateOptions {
  bool fixed_smoothness = false;
  int holdout = 0;                                    // every so many holes are left out; 0: none
  std::optional<recording::Recording> specimen = {};  // of kind length
};

PlateResult EvaluatePlate(const machine::Machine& machine,
                          const std::vector<simulation::PlateSetup>& setups,
                          const PlateOptions& options);

}  // namespace abbe::apps
