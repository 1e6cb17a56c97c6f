// The five errors of the swept axis from five readings.
//
//   const SmallAngleInversion invert(layout, MovingBody::kTarget);
//   const HeadErrors<> errors = invert(readings, d);
//   invert.Invert(table, travels, exx, all_errors);  // many stations
//
// Three inversions, each for a moving target and for a moving head. Frame, signs and the order of
// the readings are those of head_model.h; `exx` is the positioning error where it is
// known.
//   SimplifiedInversion  first order in the errors: the published equations, for any layout.
//   SmallAngleInversion  exact for SmallAngleReadings.
//   RigidInversion       exact for RigidReadings, for any measuring lines.
// The exact inversions are closed forms without iteration. The three top readings fix the plane of
// the top face, the two side readings that of the side face. What remains is a quadratic in the yaw
// (small angles) or the rotation with two known normals (rigid). The residual is rounding.
//
// Frames: H, as in head_model.h.
// Units: m and rad. Shapes: five readings in the order A, B, C, D, E; the errors of HeadErrors; many
// stations in rows.
// Failure: a constructor throws InputError for a layout that does not determine the errors: top
// probes on a line, or side probes with the same u. The exact inversions throw NumericalError for
// readings that no small motion gives (never NaN), of many stations for the first of them, and
// InputError for numbers of rows that differ; SimplifiedInversion does not fail.
// Source: docs/theory-head.md. The published first-order equations, 8 to 12 of Kweon, Liu, Yang,
// are missing from the copy at hand and are derived again there; the exact inversions are the
// project's.
// Validity: stations of many are those of one to 4 eps of the largest number that goes into an
// error, whatever the width of the processor's vectors. SimplifiedInversion neglects second order:
// for the nominal layout, 1 mrad and 50 um up to 1e-6 rad and 0.09 um, at any travel.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "probes/head_model.h"

namespace abbe::probes {

// The slopes of the plane through the three top readings; the layout is inverted once.
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

  // To first order a moving head reads minus what a moving target would give at d = 0.
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
  double travels_;       // 1 a moving target, 0 a moving head: the lever has no travel
  double inverse_span_;  // 1/m: of the side probes along u
};

class SmallAngleInversion {
 public:
  SmallAngleInversion(const HeadLayout<>& layout, MovingBody moving);
  HeadErrors<> operator()(const PerProbe<>& readings, double d, double exx = 0) const;

  using Readings = Eigen::Matrix<double, Eigen::Dynamic, static_cast<int>(kProbes)>;
  using Errors = Eigen::Matrix<double, Eigen::Dynamic, 6>;
  // Many stations at once, one a row: readings N x 5, travel N x 1, EXX N x 1 or empty for zero;
  // the errors become N x 6 in the order of HeadErrors.
  void Invert(const Eigen::Ref<const Readings>& readings,
              const Eigen::Ref<const Eigen::VectorXd>& d,
              const Eigen::Ref<const Eigen::VectorXd>& exx, Errors& errors) const;

  // With the slopes of the top surface p = (EBX + EAX ECX) / (1 + ECX^2) along -u and
  // q = (EAX - EBX ECX) / (1 + ECX^2) along s, EAX = q + p ECX and EBX = p - q ECX. Put into the
  // difference E - D of the side readings, a quadratic in ECX alone remains.
  HeadErrors<> MovingTarget(const PerProbe<>& readings, double d, double exx) const {
    const auto [slope_u, q] = top_(readings);
    const double p = -slope_u;
    const auto& [side_d, side_e] = layout_.side;
    const double du = side_e.u - side_d.u, dn = side_e.n - side_d.n;
    const double m = readings[4] - readings[3];
    const double a = q * (p * du + dn - m * q);
    const double b = (1 + q * q - p * p) * du + 2 * p * (m * q - dn);
    const double c = -q * (p * du + dn) - m * (1 + p * p);
    HeadErrors<> e{.exx = exx};
    e.ecx = -2 * c / (b + std::copysign(std::sqrt(b * b - 4 * a * c), b));
    e.eax = q + p * e.ecx;
    e.ebx = p - q * e.ecx;

    // Both straightnesses: EZX - q EYX and EYX + w EZX are known.
    const double per = 1 / (1 + e.ebx * e.ebx);
    const double s = per * (e.ecx - e.eax * e.ebx), w = per * (e.eax + e.ebx * e.ecx);
    const double top = readings[0] - q * layout_.top[0].s - p * (d + exx - layout_.top[0].u);
    const double side = readings[3] + s * (d + exx - side_d.u) + w * side_d.n;
    e.ezx = (top + q * side) / (1 + q * w);
    e.eyx = side - w * e.ezx;
    return e;
  }

  // Whether these are errors of small motions, and numbers.
  static bool IsSmall(const HeadErrors<>& e) {
    return std::abs(e.eax) + std::abs(e.ebx) + std::abs(e.ecx) < 1 && std::isfinite(e.eyx + e.ezx);
  }

 private:
  void RefuseFirst(const Readings& readings, const Eigen::VectorXd& d, const Errors& errors) const;

  HeadLayout<> layout_;
  MovingBody moving_;
  TopPlane top_;
  SimplifiedInversion linear_;  // exact for a moving head: there the small-angle model is linear
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
