// The reading of a capacitive probe over a tilted surface and with stray capacitance; its inverse.
//
// A gap is positive, from the electrode to the surface. The reading is the gap at which an ideal
// probe, whose capacitance is inverse to its gap, would have the same capacitance.
//
//   tilt    a circular electrode of radius a over a surface tilted by phi:
//           m = g (1 + sqrt(1 - (a phi / g)^2)) / 2,   and back:   g = m + (a phi)^2 / (4 m)
//   stray   a constant capacitance in parallel with the gap, k per length of gap:
//           m = g / (1 + k g),                         and back:   g = m / (1 - k m)
//
// The tilt acts first, then the stray capacitance. Both act on the gap itself, not on its change.
//
// Units: m, rad, 1/m. Shapes: one reading at a time.
// Failure: InputError where the edge of the electrode would touch the surface (a phi >= g), or
// where no finite gap gives the reading (k m >= 1).
// Source: the integral of 1/gap over the disc, docs/theory-head.md.
// Validity: straight field lines without fringe; the gap is small against the radius.
#pragma once

#include <cmath>

#include "failure/failure.h"

namespace abbe::probes {

struct Electrode {
  double radius = 0;  // m; 0: the probe sees one point
  double stray = 0;   // 1/m: stray capacitance over (permittivity times electrode area)
};

// The reading at the gap `gap` over a surface tilted by `tilt`. T: double or a dual number.
template <typename T>
T ElectrodeReading(const Electrode& electrode, const T& gap, double tilt) {
  using std::sqrt;
  const T edge = electrode.radius * tilt / gap;
  if (!(gap > T(0)) || !(edge * edge < T(1))) {
    throw InputError(
        "electrode: the gap is not above the tilt times the electrode radius, so the electrode "
        "would touch the target; check the gap and [head] electrode_radius_mm");
  }
  const T tilted = gap * (T(1) + sqrt(T(1) - edge * edge)) / T(2);
  return tilted / (T(1) + electrode.stray * tilted);
}

// The gap that gives `reading` over a surface tilted by `tilt`.
inline double ElectrodeGap(const Electrode& electrode, double reading, double tilt) {
  const double tilted = reading / (1 - electrode.stray * reading);
  const double edge = electrode.radius * tilt / 2;
  if (!(reading > 0) || !(electrode.stray * reading < 1) || !(tilted > std::abs(edge))) {
    throw InputError(
        "electrode: no gap gives this reading with these electrode constants; check the reading "
        "and [head] electrode_radius_mm and stray_per_mm");
  }
  return tilted + edge * edge / tilted;
}

}  // namespace abbe::probes
