// The effect of the tolerances of a linkage on its tip: one parameter at a time, and Sobol's
// indices.
//
//   const SensitivityVolume cube{.size = {0.025, 0.025, 0.050}};
//   const auto poses = PosesInVolume(settings, cube);
//   const auto result = AnalyseSensitivity(model, poses, {.draws = 4096, .seed = 1});
//   result.parameters[0].alone;   // m
//
// The parameters are drawn from their priors, normal and independent; the tip errors are those of
// all poses together, so an index is a share of the mean squared tip error. A held parameter does
// not vary and is left out.
// Frames: the volume stands in M as the workpiece carries it (linkage_settings.h, NominalTip).
// Units: m, rad. Shapes: one entry per free parameter, in the order of the model.
// Failure: InputError for a volume without size or fewer than two points an edge; NumericalError
// when a pose is out of reach or singular.
// Source: estimation/sobol_indices.h.
// Validity: with `warmth` 0 the links are at their reference temperature, and the expansion has no
// effect.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "estimation/sobol_indices.h"
#include "relm/linkage_model.h"
#include "relm/linkage_settings.h"

namespace abbe::relm {

struct SensitivityVolume {
  Eigen::Vector3d size{0.025, 0.025, 0.050};         // m
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // m, in M
  int points = 3;                                    // along each edge
};

// The encoder angles of the nominal linkage at the points of the volume; its centre first.
LinkageReadings PosesInVolume(const LinkageSettings& settings, const SensitivityVolume& volume,
                              double warmth = 0);

struct SensitivityOptions {
  bool displacement = false;  // errors relative to that of the first pose, which does not count
  std::uint64_t draws = 2048;
  std::uint64_t seed = 1;
  int threads = 0;  // 0: all
};

struct ParameterSensitivity {
  std::string name;  // "block.entry"
  estimation::PrintUnit unit;
  double tolerance;  // SI: the prior's standard deviation
  double alone;      // m: tip error, root mean square over the poses, when only this parameter
                     // deviates, by its tolerance
  double worst;      // m: the largest of these tip errors
  estimation::SobolIndex share;  // of the mean squared tip error of all parameters together
};

struct LinkageSensitivity {
  double together;  // m: root mean square tip error over poses and draws
  std::vector<ParameterSensitivity> parameters;  // in the order of the model
};

// Parameters one at a time, then all together.
LinkageSensitivity AnalyseSensitivity(const LinkageModel& model, const LinkageReadings& poses,
                                      const SensitivityOptions& options = {});

}  // namespace abbe::relm
