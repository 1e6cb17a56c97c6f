// A run whose rows are points of the machine (machine_points.h) without causes: its positions.
#pragma once

#include <cstddef>
#include <vector>

#include "simulation/correction.h"
#include "simulation/points/machine_points.h"

namespace abbe::simulation {

// Points that share a trace, and all rows of the recording that belong to them.
struct PartOfPoints {
  MachinePoints points;  // where the trace has its rows
  Trace trace;
  std::vector<std::size_t> rows;
};

Correction CorrectPoints(const recording::Recording& recording, std::vector<PartOfPoints> parts,
                         const std::vector<ModelledCause>& causes, const Origin& origin,
                         const Instruments& on);

}  // namespace abbe::simulation
