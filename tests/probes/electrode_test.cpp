#include "probes/electrode.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "failure/failure.h"

namespace abbe::probes {
namespace electrode_test {

// The harmonic mean of the gap over a disc of radius a tilted by phi, by quadrature: with x = a sin
// t a strip of the disc has the area 2 a^2 cos^2 t dt, and the trapezoid rule over the period
// converges faster than any power.
double HarmonicMean(double gap, double radius, double tilt) {
  constexpr int kSteps = 2000;
  double mean = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double t = 2 * std::numbers::pi * i / kSteps;
    mean += 2 * std::cos(t) * std::cos(t) / (gap + tilt * radius * std::sin(t)) / kSteps;
  }
  return 1 / mean;
}

TEST(Electrode, ReadsTheHarmonicMeanOfTheGap) {
  for (const double edge : {0.0, 0.1, 0.5, 0.9, 0.99}) {  // tilt radius / gap
    const double gap = 100e-6, radius = 2.5e-3, tilt = edge * gap / radius;
    const double reading = ElectrodeReading({.radius = radius}, gap, tilt);
    EXPECT_NEAR(reading / HarmonicMean(gap, radius, tilt), 1, 1e-13) << edge;  // sum of 2000 terms
    EXPECT_DOUBLE_EQ(reading, ElectrodeReading({.radius = radius}, gap, -tilt));
  }
}

// Capacitances add: 1/m = 1/g + k, all over permittivity times area.
TEST(Electrode, AddsTheStrayCapacitance) {
  const double gap = 100e-6, stray = 500;
  EXPECT_NEAR(1 / ElectrodeReading({.stray = stray}, gap, 0), 1 / gap + stray, 1e-11);
  const double tilted = HarmonicMean(gap, 2.5e-3, 0.03);
  EXPECT_NEAR(1 / ElectrodeReading({.radius = 2.5e-3, .stray = stray}, gap, 0.03),
              1 / tilted + stray, 1e-8);  // the quadrature, relative 1e-12
}

TEST(Electrode, RefusesTheImpossible) {
  const Electrode electrode{.radius = 2.5e-3, .stray = 500};
  EXPECT_THROW(ElectrodeReading(electrode, 100e-6, 0.04), InputError);  // the edge touches
  EXPECT_THROW(ElectrodeReading(electrode, 0.0, 0.0), InputError);
  EXPECT_THROW(ElectrodeReading(electrode, -1e-6, 0), InputError);
  EXPECT_THROW(ElectrodeReading(electrode, std::nan(""), 0), InputError);
  EXPECT_THROW(ElectrodeGap(electrode, 2e-3, 0), InputError);      // k m = 1: an infinite gap
  EXPECT_THROW(ElectrodeGap(electrode, 40e-6, 0.04), InputError);  // below half the edge
  EXPECT_THROW(ElectrodeGap(electrode, -1e-6, 0), InputError);
}

}  // namespace electrode_test
}  // namespace abbe::probes
