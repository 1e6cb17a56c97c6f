// The structures that a report lists as not explained.
//
//   const std::vector<Leftover> left = LeftoversOf(fit, found);   // empty: all is explained
//
// The strongest answer of each channel whose probability, times the number of questions asked, is
// below `kDoubt`; each channel once, at most six.
// Units: SI. Failure: none. Source: structure_question.h. Validity: to first order at the fit.
#pragma once

#include <cstddef>
#include <vector>

#include "diagnosis/fit.h"
#include "diagnosis/structure_question.h"
#include "diagnosis/unexplained.h"

namespace abbe::diagnosis {

inline constexpr double kAsGood = 3.0;  // in the logarithm of a probability: one of twenty

// Another variable or channel with which the data go as well, each once.
void AddAlike(const Structure& other, Found& found);

std::vector<Leftover> LeftoversOf(const Fit& fit, const std::vector<Found>& found);
// One of so many questions.
Leftover LeftoverOf(const Fit& fit, const Found& found, std::size_t questions);

}  // namespace abbe::diagnosis
