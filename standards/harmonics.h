// Harmonics of a quantity over a closed turn: a Fourier sum fitted to readings at any angles.
//
//   const HarmonicFit fit = FitHarmonics(angles, values, 4);
//   fit.Order(2).Amplitude();  fit.At(angle);
//
//   value(t) = mean + sum over n = 1 .. highest of c_n cos(n t) + s_n sin(n t)
//
// For a radius, order 1 is an eccentricity, 2 an ellipse, 3 and more are lobes. Units: angles in
// rad, all else in the unit of the values. Shapes: lists of equal length, any order and spacing,
// any number of turns. `u` is the standard uncertainty of a coefficient for independent residuals;
// those of neighbouring readings often are not. Failure: InputError for lists of different length,
// values that are not finite, or fewer readings than coefficients; NumericalError when the angles
// do not separate the coefficients (an arc that is too short for the order).
// Source: linear least squares. Validity: readings at equal spacing give the discrete Fourier
// transform; otherwise orders above `highest` leak into those below.
#pragma once

#include <cmath>
#include <span>
#include <vector>

namespace abbe::standards {

struct Harmonic {
  int order = 0;
  double cosine = 0.0;
  double sine = 0.0;
  double u = 0.0;

  double Amplitude() const { return std::hypot(cosine, sine); }
  // Where the wave has its first maximum is Phase() / order.
  double Phase() const { return std::atan2(sine, cosine); }
};

struct HarmonicFit {
  double mean = 0.0;
  std::vector<Harmonic> harmonics;  // order 1, 2, ...
  double rms = 0.0;                 // of the residuals

  const Harmonic& Order(int order) const { return harmonics[order - 1]; }
  double At(double angle) const;
};

HarmonicFit FitHarmonics(std::span<const double> angles, std::span<const double> values,
                         int highest);

}  // namespace abbe::standards
