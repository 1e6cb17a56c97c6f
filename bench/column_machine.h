// The machine of the benchmarks: a column machine with travels of half a metre whose 18 errors are
// cubic B-splines of 12 coefficients, some 20 um and urad large.
#pragma once

#include <cmath>

#include "geometry/b_spline.h"
#include "machine/configurations.h"
#include "machine/standard_forms.h"
#include "machine/volumetric_model.h"

namespace abbe::bench {

inline constexpr double kTravel = 0.5;  // m
inline constexpr int kCoefficients = 12;

inline machine::VolumetricModel ColumnMachine() {
  machine::VolumetricModel model(machine::ChainOf("column"),
                                 {{{0, kTravel}, {0, kTravel}, {0, kTravel}}});
  const machine::SharedForm form =
      machine::MakeBSplineForm(geometry::BSplineBasis::Uniform(3, 0.0, kTravel, kCoefficients));
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    for (int motion = 0; motion < machine::kMotions; ++motion) model.SetForm(axis, motion, form);
  }
  Eigen::VectorXd p(model.ParameterCount());
  for (Eigen::Index i = 0; i < p.size(); ++i) p[i] = 20e-6 * std::cos(1.7 * static_cast<double>(i));
  model.SetParameters(p);
  return model;
}

}  // namespace abbe::bench
