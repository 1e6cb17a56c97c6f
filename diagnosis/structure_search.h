// The structures that the data show beside a fit, strongest first.
//
//   const std::vector<Found> found = FindStructures(fit);
//
// Each channel is asked of each recorded variable whether a structure (structure.h) would make the
// channel fit better (structure_question.h): a smooth function, the strongest line of up to kLines
// wave numbers, the strongest interval (scan.h), a product.
// Units: SI. Failure: none. Source: structure_question.h. Validity: to first order at the fit.
#pragma once

#include <vector>

#include "diagnosis/fit.h"
#include "diagnosis/structure_question.h"

namespace abbe::diagnosis {

// The least probable by chance first.
std::vector<Found> FindStructures(const Fit& fit);

}  // namespace abbe::diagnosis
