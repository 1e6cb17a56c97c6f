// Where a finding shows: measured less simulated on the variable on which it depends most, without
// and with all that was found.
//
//   const Curve curve = CurveOf(base, found, 0);
//
// Each row of the runs says, by itself, what is left at the stage at which the cause acts; rows of
// one part of the variable's range and one direction of motion are averaged. Of all variables that
// is taken whose averages keep most of what the cause does; none where all keep less than half.
// Units: SI. Shapes: at, before, after of equal length.
// Failure: none.
// Validity: averages of rows, for the eye; the evidence is that of all rows.
#pragma once

#include <Eigen/Core>
#include <string>

#include "diagnosis/fit.h"
#include "estimation/parameter.h"

namespace abbe::diagnosis {

struct Curve {
  std::string variable;
  estimation::PrintUnit variable_unit, unit;
  Eigen::VectorXd at, before, after;  // in the order of `at`; empty: it shows at no stage
};

// `taken_in`: index of the cause in `found`.
Curve CurveOf(const Fit& base, const Fit& found, std::size_t taken_in);

// The largest change of the volumetric error over the travels from one fit to another, m: 0 without
// axes.
double MapChange(const Fit& base, const Fit& found);

}  // namespace abbe::diagnosis
