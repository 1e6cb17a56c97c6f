// A linkage that no machine carries, before a reference instrument: the arm of a robot and a
// tracker.
//
//   if (IsArm(recording)) {
//     const LinkageRun run = MeansOfStays(ReadLinkageRun(recording, settings));
//     const relm::LinkageSettings placed = Placed(settings, run);
//   }
//
// Such a recording is of kind linkage, with ref_x_mm, ref_y_mm, ref_z_mm and without x_mm, y_mm,
// z_mm. Its frame M is that of the instrument, whose place the machine file does not know.
#pragma once

#include "recording/recording.h"
#include "relm/linkage_settings.h"
#include "simulation/linkage/linkage_run.h"
#include "simulation/linkage/linkage_simulation.h"
#include "simulation/simulated_run.h"

namespace abbe::simulation {

bool IsArm(const recording::Recording& recording);

// The linkage with its base where the nominal arm fits best what the instrument saw, free to stand
// kAnywhere and kAnyTurn off. Gravity keeps its direction in the frame of the base; weights act by
// their levers (relm/weights.h), with a turn of kLight a metre until a cause says more, and not by
// the compliance of single links, which hangs on the points that are written.
// Units: m, rad, rad/m. Failure: InputError for poses on one line, about which the turn is open.
inline constexpr double kAnywhere = 0.5, kAnyTurn = 1.0, kTooNear = 20e-3, kLight = 20e-6;
relm::LinkageSettings Placed(relm::LinkageSettings settings, const LinkageRun& run);

// A run that stays within kTooNear (rms) of one place tells nothing of the geometry: then all of it
// is held, but for the position of the base.
relm::LinkageSettings HeldAtOnePlace(relm::LinkageSettings placed, const LinkageRun& run);

// The arm alone, with all that its machine file leaves open.
LinkageSimulation ArmSimulation(const relm::LinkageSettings& placed);

// Its run, to be fitted from `x` on; the noise is `excess` times the stated one. Kind "linkage".
SimulatedRun SimulateArm(const LinkageSimulation& arm, const LinkageRun& run,
                         const Eigen::VectorXd& x, double excess);

}  // namespace abbe::simulation
