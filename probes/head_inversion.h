// From five readings to the five errors of the swept axis.
//
//   const DocumentInversion invert(layout, MovingBody::kTarget);
//   const HeadErrors<> errors = invert(readings, d);
//
// Three inversions, each for both bodies that may move. Frames, units, signs and the order of the
// readings are those of head_model.h; `exx` is the positioning error where it is known.
//   SimplifiedInversion  first order in the errors: the source's equations 8 to 12, for any layout;
//   DocumentInversion    exact for DocumentReadings;
//   RigidInversion       exact for RigidReadings, for any measuring lines.
// The exact ones are closed forms, not iterations: three readings fix the top plane, two more the
// side plane, and what remains is a quadratic in the yaw (document) or the rotation of two known
// normals (rigid). Their residual error is rounding.
//
// Failure: a constructor throws InputError for a layout that cannot tell the errors apart: top
// probes on a line, or side probes with the same u. The exact inversions throw NumericalError for
// readings that no small motion gives (never NaN); SimplifiedInversion does not fail. Source:
// docs/theory-head.md; the printed equations 8 to 12 are lost in the copy of seed 004. Validity:
// SimplifiedInversion neglects second order: at 1 mrad and 50 um up to 1e-6 rad, and 0.09 um at d =
// 60 mm.
#pragma once

#include "probes/head_model.h"

namespace abbe::probes {

// The plane z = height + slope_u u + slope_s s through three points; precomputed for fixed (u, s).
class TopPlane {
 public:
  explicit TopPlane(const std::array<TopPosition<double>, kTopProbes>& positions);

  struct Slopes {
    double u, s;
  };
  Slopes operator()(const PerProbe<>& readings) const {
    const double b = readings[1] - readings[0], c = readings[2] - readings[0];
    return {ub_ * b + uc_ * c, sb_ * b + sc_ * c};
  }

 private:
  double ub_, uc_, sb_, sc_;  // 1/m
};

class SimplifiedInversion {
 public:
  SimplifiedInversion(const HeadLayout<>& layout, MovingBody moving);
  HeadErrors<> operator()(const PerProbe<>& readings, double d, double exx = 0) const;

 private:
  HeadLayout<> layout_;
  MovingBody moving_;
  TopPlane top_;
};

class DocumentInversion {
 public:
  DocumentInversion(const HeadLayout<>& layout, MovingBody moving);
  HeadErrors<> operator()(const PerProbe<>& readings, double d, double exx = 0) const;

 private:
  HeadLayout<> layout_;
  MovingBody moving_;
  TopPlane top_;
  SimplifiedInversion linear_;  // a moving head: the document's model is linear
};

class RigidInversion {
 public:
  RigidInversion(const MeasuringLines<>& lines, MovingBody moving);
  HeadErrors<> operator()(const PerProbe<>& readings, double d, double exx = 0) const;

 private:
  MeasuringLines<> lines_;
  MovingBody moving_;
};

}  // namespace abbe::probes
