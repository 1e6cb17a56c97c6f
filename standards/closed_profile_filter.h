// The Gaussian low-pass filter of a closed profile, with its cutoff in undulations per turn.
//
//   const std::vector<double> smooth = FilterClosedProfile(angles, values, 50.0);
//
//   weight(d) = exp(-pi (d / (a w))^2),  w = 2 pi / cutoff,  a = sqrt(ln 2 / pi)
//
// A wave of n undulations per turn keeps exp(-ln 2 (n / cutoff)^2) of its amplitude: half at
// cutoff.
//
// Units: angles in rad, cutoff in undulations per turn. Shapes: lists of equal length, in any
// order; readings of several turns are averaged by the weights; the result is in the order given.
// Failure: InputError for lists of different length, values that are not finite or a cutoff that is
// not positive. Source: ISO 16610-21:2011, clause 5 (closed profiles), and ISO 12181-2:2011; not
// checked against their texts. See also Precision Engineering 38 (2014) 439 (periodic Gaussian
// filter). Validity: weights are normalised over the readings, so the spacing should be even over
// the width of the filter.
#pragma once

#include <span>
#include <vector>

namespace abbe::standards {

std::vector<double> FilterClosedProfile(std::span<const double> angles,
                                        std::span<const double> values, double cutoff);

}  // namespace abbe::standards
