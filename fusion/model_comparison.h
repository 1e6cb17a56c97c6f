// The error models side by side on one recording: what each more complete one is worth.
//
//   for (const ComparedModel& row : CompareModels(chain, linkage, run, options)) ...
//
// Rows: the nominal linkage, then for each model the calibrated linkage, global and, where the
// poses form a grid, mapped. `options.model` and `options.mapped` are not looked at.
// Units: m. Failure: that of Calibrate; a model that this form of linkage does not have is left
// out. Source of the order: Boelens (2006), see fusion/mapping.h; the complete model is beyond it.
#pragma once

#include <string>
#include <vector>

#include "fusion/calibrate.h"

namespace abbe::fusion {

struct ComparedModel {
  std::string name;             // "published, mapped"
  Eigen::Index parameters = 0;  // of the model, of each cell where mapped
  Distances after;              // of the poses that it was calibrated with
  Distances held_out;           // of poses that took no part
};

std::vector<ComparedModel> CompareModels(const machine::Chain& chain,
                                         const relm::LinkageSettings& settings,
                                         const simulation::LinkageRun& run,
                                         CalibrateOptions options);

}  // namespace abbe::fusion
