// A dual number, value and derivatives, for models that differentiate row by row.
//
//   DualNumber<6> x(0.3);
//   x.v[0] = 1.0;                                // seed: d/dx_0
//   const auto y = sin(x);                       // y.a the value, y.v the derivatives
//
// Where a whole residual is one template, use autodiff_residual.h.
// Cost: each model costs about 3 s of compilation; include this from few .cpp files, never from a
// public header.
// Units: those of the model. Shapes: a value and kDerivatives derivatives.
// Failure: none; a number that is not finite passes through.
// Source: ceres::Jet of the Ceres Solver.
// Validity: exact to rounding where the model is differentiable.
#pragma once

#include <ceres/jet.h>

namespace abbe::estimation {

template <int kDerivatives>
using DualNumber = ceres::Jet<double, kDerivatives>;

}  // namespace abbe::estimation
