// Plausible positions of an axis: its travel, widened at both ends by a tenth of it and 10 mm. A
// position outside is a mistake: a wrong order of words, a wrong scale or unit, another axis.
// Units: m.
// Failure: none here; the readers of recordings refuse a position outside.
// Source: own.
// Validity: a mistake of less than a tenth of the travel is not seen.
#pragma once

#include "machine/machine.h"

namespace abbe::machine {

// The widened travel.
inline Travel PlausiblePositions(const Travel& travel) {
  const double beyond = 0.1 * (travel.last - travel.first) + 10e-3;
  return {travel.first - beyond, travel.last + beyond};
}

}  // namespace abbe::machine
