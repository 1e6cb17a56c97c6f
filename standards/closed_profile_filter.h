// The Gaussian low-pass filter of a closed profile: what lies above so many undulations a turn
// goes.
//
//   const std::vector<double> smooth = FilterClosedProfile(angles, values, 50.0);
//
//   weight(d) = exp(-pi (d / (a w))^2),  w = 2 pi / cutoff,  a = sqrt(ln 2 / pi)
//
// so a wave of `cutoff` undulations a turn keeps half of its amplitude, one of n keeps
// exp(-ln 2 (n / cutoff)^2). Units: angles in rad, cutoff in undulations a turn. Shapes: lists of
// one length, in any order; readings of several turns stand side by side and are averaged; the
// result is in the order given. Failure: InputError for lists of different length, values that are
// not finite or a cutoff that is not positive. Source: ISO 16610-21:2011, clause 5 (closed
// profiles), and ISO 12181-2:2011; not checked against their texts. See also Precision
// Engineering 38 (2014) 439 (periodic Gaussian filter). Validity: weights are normalised over the
// readings there are, so spacing should be even over the filter's width.
#pragma once

#include <span>
#include <vector>

namespace abbe::standards {

std::vector<double> FilterClosedProfile(std::span<const double> angles,
                                        std::span<const double> values, double cutoff);

}  // namespace abbe::standards
