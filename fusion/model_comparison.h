// Compares the error models on one recording.
//
//   for (const ComparedModel& row : CompareModels(chain, linkage, run, {circle}, options)) ...
//
// Rows: the reference itself (its circles only), the nominal linkage, then for each model the
// calibrated linkage: global; where the poses form a grid also by the one cell in its middle alone,
// and mapped. `checks` are runs that are not calibrated with, such as a circle. `options.model`,
// `options.mapped` and `options.contradict` are ignored.
// Units: m. Shapes: one row a model, in the order above.
// Failure: that of Calibrate; a model that this form of linkage does not have is left out.
// Source of the order: Boelens (2006), see fusion/mapping.h; the complete model is beyond it.
// Validity: held-out figures compare models; `after` favours the one with the most parameters.
#pragma once

#include <string>
#include <vector>

#include "fusion/calibrate.h"

namespace abbe::fusion {

// The deviations of a linkage on a run that it was not calibrated with.
struct CheckedRun {
  Distances distance;  // from the reference; as displacements for the nominal linkage
  // Largest distance of the path from its least-squares circle, in the plane of the two axes that
  // move most; NaN where that is more than a hundredth of the radius: no circle.
  double circle = 0.0;
};

struct ComparedModel {
  std::string name;             // "published, mapped"
  Eigen::Index parameters = 0;  // of the model, of each cell where mapped
  Distances after;              // of the poses that it was calibrated with
  Distances held_out;           // of held-out poses; NaN for one cell
  std::vector<CheckedRun> checks;
};

// Calibrates with `run`, judges by `checks`.
std::vector<ComparedModel> CompareModels(const machine::Chain& chain,
                                         const relm::LinkageSettings& settings,
                                         const simulation::LinkageRun& run,
                                         const std::vector<simulation::LinkageRun>& checks,
                                         CalibrateOptions options);

// The largest distance of a path from its circle, as above.
double CircleDeviation(const Eigen::Matrix3Xd& path);

}  // namespace abbe::fusion
