#include "simulation/linkage/linkage_correction.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>

#include "machine/volumetric_jacobian.h"
#include "simulation/correction_steps.h"
#include "simulation/linkage/linkage_run.h"
#include "simulation/linkage/linkage_simulation.h"
#include "simulation/linkage/linkage_trace.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using recording::Recording;

// What one pose changes by.
struct Steps {
  Eigen::MatrixXd angles;  // pivots x poses
  Matrix3Xd axes;          // [x y z]
};

Steps StepsOf(const LinkageRun& run, const LinkageSimulation& linkage, const Sums& sums,
              const VectorXd& parameters, const machine::Machine& machine) {
  Steps steps{Eigen::MatrixXd(run.readings.angles.rows(), run.poses()), Matrix3Xd(3, run.poses())};
  const Eigen::Matrix3d R_BM = linkage.settings().X_MB.R.transpose();
  const VectorXd nominal = linkage.model().Values();
  // p_MT by the positions of the axes: the way of the ball is straight.
  const Vector3d sign = relm::NominalTip(machine.chain, Vector3d::Ones());
  for (Index pose = 0; pose < run.poses(); ++pose) {
    const auto motion = machine::VolumetricErrorAndJacobian(machine.chain, run.commanded.col(pose),
                                                            -machine.reference, {});
    const double warmth = run.readings.warmth.size() == 0 ? 0.0 : run.readings.warmth[pose];
    const auto tip = linkage.model().Differentiate(run.readings.angles.col(pose), warmth, nominal);
    const auto instrument = sums.instrument.col(pose);
    const Vector3d ball =
        motion.J_error_motions * instrument.head<kToolStage>() + instrument.segment<3>(kToolStage);
    const Vector3d moved_B =
        tip.J_tip_x * parameters + instrument.segment<3>(kTipStage) - R_BM * ball;
    steps.angles.col(pose) =
        Eigen::MatrixXd(tip.J_tip_q).completeOrthogonalDecomposition().solve(moved_B) -
        instrument.tail(run.readings.angles.rows());
    steps.axes.col(pose) =
        sign.asDiagonal() * (motion.J_error_motions * sums.machine.col(pose).head<kToolStage>());
  }
  return steps;
}

}  // namespace

VectorXd ParametersMoved(const relm::LinkageModel& model,
                         const std::vector<ModelledCause>& causes) {
  const std::vector<std::string> names = model.Names();
  VectorXd moved = VectorXd::Zero(model.parameters());
  for (const ModelledCause& each : causes) {
    if (!each.cause->relaxes) continue;
    const VectorXd coefficients = each.cause->RecallFrom(each.values).coefficients;
    const std::vector<std::string> widened = each.cause->relaxes(each.object);
    for (std::size_t i = 0; i < widened.size(); ++i) {
      const auto found = std::find(names.begin(), names.end(), widened[i]);
      if (found != names.end()) moved[found - names.begin()] += coefficients[i];
    }
  }
  return moved;
}

Correction CorrectLinkage(const Recording& recording, const std::vector<ModelledCause>& causes,
                          const Origin& origin, const Instruments& on) {
  const relm::LinkageSettings& settings = on.LinkageFor(recording.name);
  Correction corrected{recording, {}};
  const LinkageSimulation linkage(on.machine.chain, settings,
                                  relm::MakeLinkageModel(settings, relm::ErrorModel::kComplete));
  const LinkageRun rows = ReadLinkageRun(recording, settings);
  const LinkageRun stays = MeansOfStays(rows);
  Trace trace = TraceOf(recording, stays, linkage);
  const Sums sums = SumsOf(trace, causes, origin);
  const Steps steps =
      StepsOf(stays, linkage, sums, ParametersMoved(linkage.model(), causes), on.machine);
  std::vector<Moved> angles, axes;
  for (Index pivot = 0; pivot < steps.angles.rows(); ++pivot) {
    angles.emplace_back(corrected.recording, fmt::format("pivot_{}_rad", pivot + 1),
                        corrected.changes.angles);
  }
  for (Index axis = 0; axis < 3; ++axis) {
    axes.emplace_back(corrected.recording, PositionColumn(axis), corrected.changes.positions);
  }
  Index stay = 0;
  for (const std::size_t row : rows.rows) {
    while (stay + 1 < stays.poses() && stays.rows[stay + 1] <= row) {
      ++stay;
    }
    for (std::size_t k = 0; k < angles.size(); ++k) {
      angles[k].By(row, steps.angles(k, stay));
    }
    for (std::size_t k = 0; k < 3; ++k) axes[k].By(row, steps.axes(k, stay));
  }
  return corrected;
}

}  // namespace abbe::simulation
