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
// Frames: M, that of the instrument; B, the base of the arm. Shapes: poses in columns; the Jacobian
// as LinkageSimulation.
// Source: docs/arms.md; geometry: relm/serial_chain.h.
// Validity: the arm stands still in each pose, and its base does not move during a run.
#pragma once

#include <string>
#include <vector>

#include "estimation/problem.h"
#include "recording/recording.h"
#include "relm/linkage_settings.h"
#include "simulation/linkage/linkage_run.h"
#include "simulation/linkage/linkage_simulation.h"
#include "simulation/simulated_run.h"

namespace abbe::simulation {

// Judged by the columns alone.
bool IsArm(const recording::Recording& recording);

// Its poses, at most kMostDiagnosedPoses, with the noise of the instrument and of how the arm repeats.
// Without time_s all are at time 0: their order is not known. Failure: that of ReadLinkageRun.
LinkageRun ReadArmRun(const recording::Recording& recording, const relm::LinkageSettings& settings);

// The linkage with its base where the nominal arm fits best what the instrument saw, free to stand
// kAnywhere and kAnyTurn off. Gravity keeps its direction in the frame of the base; weights act by
// their levers (relm/weights.h), with a turn of kLight a metre until a cause says more, and not by
// the compliance of single links, which hangs on the points that are written.
// Units: m, rad, rad/m. Failure: InputError for poses on one line, about which the turn is open.
inline constexpr double kAnywhere = 0.5, kAnyTurn = 1.0, kTooNear = 20e-3, kLight = 20e-6;
// `settings` with X_MB found, and the tolerances of a base that stands anywhere.
relm::LinkageSettings Placed(relm::LinkageSettings settings, const LinkageRun& run);

// Several balls or reflectors on one hand: the machine file states the first, the others have an
// unknown place (LinkageRun::ball), the same in all their runs. The load hangs where the file has it.
std::string BallBlock(const std::string& ball);

// Where such a ball is seen, less the one of the file: [along across axial] as the block has them.
// 0 for the ball of the file.
Eigen::Vector3d BallSeen(const relm::LinkageSettings& placed, const LinkageRun& run);

// `x` of ArmSimulation(placed) with the ball there, all else nominal.
Eigen::VectorXd StartAt(const LinkageSimulation& arm, const Eigen::Vector3d& ball);

// A run that stays within kTooNear (rms) of one place tells nothing of the geometry: then all of it
// is held, but for the position of the base.
relm::LinkageSettings HeldAtOnePlace(relm::LinkageSettings placed, const LinkageRun& run);

// The arm alone, with all that its machine file leaves open.
LinkageSimulation ArmSimulation(const relm::LinkageSettings& placed);

// Its run, to be fitted from `x` on; the noise is `excess` times the stated one. Kind "linkage".
SimulatedRun SimulateArm(const LinkageSimulation& arm, const LinkageRun& run,
                         const Eigen::VectorXd& x, double excess);

// Runs of one arm as one problem: their blocks are shared by name. InputError for no run.
estimation::Problem ArmProblem(const std::vector<SimulatedRun>& runs);

}  // namespace abbe::simulation
