// Accuracy and repeatability of positioning of a linear axis after ISO 230-2.
//
// The axis goes to each target i = 1..m from both directions in each cycle j = 1..n; a deviation is
// x_ij = actual position - target. "up" is the approach in the positive direction, "down" the
// negative. Units: m.
// Shapes: deviations m x n, one row per target. Failure: InputError for fewer than one target,
// fewer than two cycles, numbers of cycles that differ between targets or directions, or values
// that are not finite. Source: ISO 230-2:2014, clause 3, in its symbols; not checked against its
// text, but A of four published tests, and M and the mean reversal of one, come out as their
// authors state them (tests/apps/reduce_reference_field_test.cpp):
//
//   B_i = mean_up - mean_down         B = max |B_i|         mean reversal = mean B_i
//   R_i up = 4 s_i up                 R_i = max(2 s_i up + 2 s_i down + |B_i|, R_i up, R_i down)
//   R = max R_i                       E = range of the directional means, both directions together
//   M = range of (mean_up + mean_down) / 2
//   A = max(mean_i + 2 s_i) - min(mean_i - 2 s_i), both directions together
// with s_i the standard deviation over the cycles (n - 1). Figures with _up or _down use one
// direction. Validity: the standard asks for at least five cycles and five targets per metre; fewer
// are evaluated but are not a test by the standard. A drift over the cycles increases R.
#pragma once

#include <vector>

namespace abbe::standards {

struct TargetDeviations {
  double target;
  std::vector<double> up, down;  // one per cycle
};

struct TargetFigures {
  double target;
  double mean_up, mean_down, mean;                             // mean: of both directions
  double reversal;                                             // B_i
  double std_up, std_down;                                     // s_i
  double repeatability_up, repeatability_down, repeatability;  // R_i
};

struct Positioning {
  std::vector<TargetFigures> targets;                          // in the order given
  double accuracy, accuracy_up, accuracy_down;                 // A
  double repeatability, repeatability_up, repeatability_down;  // R
  double systematic, systematic_up, systematic_down;           // E
  double mean_range;                                           // M
  double reversal;                                             // B, not negative
  double mean_reversal;                                        // B bar, signed
};

Positioning EvaluatePositioning(const std::vector<TargetDeviations>& targets);

}  // namespace abbe::standards
