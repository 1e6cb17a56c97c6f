// Straightness of an axis after ISO 230-1: deviations from a reference line and their range.
//
//   error = largest positive deviation + |largest negative deviation|
//
// Frames and units: as in standards/reference_line.h, m and rad. Deviation = measured - line,
// positive towards +y. Shapes: deviations in the order of the points. Failure: InputError as in
// ReferenceLine. Source: ISO 230-1:2012, clause 3; not checked against its text. Laws: minimum
// zone <= least squares, and minimum zone <= end points. Validity: the figure of the points as
// given. It grows with noise and with the number of points; average passes first and state the
// line.
#pragma once

#include <span>
#include <vector>

#include "standards/reference_line.h"

namespace abbe::standards {

struct Straightness {
  Line line;
  std::vector<double> deviations;
  double error;
};

Straightness EvaluateStraightness(LineKind kind, std::span<const double> x,
                                  std::span<const double> y);

}  // namespace abbe::standards
