// From five readings to the five errors of the swept axis.
//
//   const DocumentInversion invert(layout, MovingBody::kTarget);
//   const HeadErrors<> errors = invert(readings, d);
//
// Three inversions, each for both bodies that may move. Frames, units, signs and the order of the
// readings are those of head_model.h; `exx` is the positioning error where it is known.
//   SimplifiedInversion  first order in the errors: the published equations, for any layout,
//   DocumentInversion    exact for DocumentReadings,
//   RigidInversion       exact for RigidReadings, for any measuring lines.
// The exact ones are closed forms, not iterations: three readings fix the top plane, two more the
// side plane, and what remains is a quadratic in the yaw (document) or the rotation of two known
// normals (rigid). Their residual error is rounding.
//
// Failure: a constructor throws InputError for a layout that cannot tell the errors apart: top
// probes on a line, or side probes with the same u. The exact inversions throw NumericalError for
// readings that no small motion gives (never NaN); SimplifiedInversion does not fail.
// Source: Kweon, Liu, Yang, equations 8 to 12; the exact ones are derived in docs/theory-head.md.
// Validity: SimplifiedInversion neglects second order: for the nominal layout, 1 mrad and 50 um up
// to 1e-6 rad and 0.09 um, at any travel.
#pragma once

#include "probes/head_model.h"

namespace abbe::probes {

// The slopes of the plane through three readings, from the layout's inverse computed once.
class TopPlane {
 public:
  explicit TopPlane(const HeadLayout<>& layout);

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

  // A moving head sees what a target that moves the other way would show at d = 0.
  HeadErrors<> operator()(const PerProbe<>& readings, double d, double exx = 0) const {
    const auto& [x_a, y_a] = layout_.top[0];
    const auto& [x_d, z_d] = layout_.side[0];
    const double sign = sign_, lever = travels_ * (d + exx);
    const auto [slope_u, slope_s] = top_(readings);
    HeadErrors<> e{.eax = sign * slope_s, .ebx = -sign * slope_u, .exx = exx};
    const double side = sign * (readings[4] - readings[3]);
    e.ecx = (side + e.eax * (layout_.side[1].n - z_d)) * inverse_span_;
    e.eyx = sign * readings[3] + z_d * e.eax + (lever - x_d) * e.ecx;
    e.ezx = sign * readings[0] - y_a * e.eax - (lever - x_a) * e.ebx;
    return e;
  }

 private:
  HeadLayout<> layout_;
  TopPlane top_;
  double sign_;          // +1 a moving target, -1 a moving head
  double travels_;       // 1 a moving target, 0 a moving head
  double inverse_span_;  // 1/m: of the side probes along u
};

class DocumentInversion {
 public:
  DocumentInversion(const HeadLayout<>& layout, MovingBody moving);
  HeadErrors<> operator()(const PerProbe<>& readings, double d, double exx = 0) const;

 private:
  HeadErrors<> MovingTarget(const PerProbe<>& readings, double d, double exx) const;

  HeadLayout<> layout_;
  MovingBody moving_;
  TopPlane top_;
  SimplifiedInversion linear_;  // exact for a moving head: there the document's model is linear
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
