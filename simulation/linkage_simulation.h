// What a run of the linkage should read: command -> machine -> ball -> linkage -> encoders.
//
// The ball sits in the spindle and at the end of the linkage, whose base stands on the table. So
// the loop table - machine - spindle - ball - linkage - table closes, in frame M:
//
//   gap = X_MB p_BT(readings - encoder effects) - (p_MT(command) + motion effects) = 0
//
// This one equation is used three ways. To fit: the gap of measured readings is what noise and
// wrong parameters leave (Gap, with derivatives). To predict: the readings that close the gap
// (Readings). To diagnose: the columns of a further effect. Where a reference gives the true
// position of a direction, that stands for p_MT + motion effects.
//
//   const LinkageSimulation simulation(chain, linkage.X_MB, model);
//   const Eigen::MatrixXd angles = simulation.Readings(run, simulation.Values(), near);
//
// Frames: M, the machine frame as the workpiece carries it; B, the linkage base; T, the ball.
// X_MB = nominal pose, then shifted by [x y z] in M and turned by exp([a b c]) in B.
// Units: m, rad. Shapes: x is [base | base_turn | blocks of the linkage | block of each effect];
// gaps 3 x poses, the Jacobian has rows x, y, z of pose 0, then of pose 1, ...
// Failure: InputError when x has the wrong size; Readings throws NumericalError with the recording
// and row of a pose that the linkage does not reach. Source: docs/calibration.md. Validity: exact
// kinematics; without motion effects the machine is perfect.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "estimation/parameter.h"
#include "estimation/residual.h"
#include "geometry/transform.h"
#include "machine/chain.h"
#include "relm/linkage_model.h"
#include "simulation/effect.h"
#include "simulation/linkage_run.h"

namespace abbe::simulation {

class LinkageSimulation {
 public:
  LinkageSimulation(machine::Chain chain, const geometry::Transform<double>& X_MB,
                    relm::LinkageModel model,
                    std::vector<std::shared_ptr<const Effect>> effects = {});

  const relm::LinkageModel& model() const { return model_; }
  const geometry::Transform<double>& X_MB() const { return X_MB_; }  // nominal
  Eigen::Index parameters() const { return parameters_; }
  Eigen::VectorXd Values() const;  // nominal base, the model's values, effects absent
  // Of the linkage and of the effects, in the order of x after the base.
  std::vector<estimation::ParameterBlock> Blocks() const;

  // The first six of x are [x y z a b c] of the base.
  geometry::Transform<double> BaseAt(const Eigen::VectorXd& x) const;

  // Where the ball of the machine without effects stands, by the reference where there is one.
  Eigen::Matrix3Xd NominalBall(const LinkageRun& run) const;

  void Gap(const LinkageRun& run, const Eigen::VectorXd& x, Eigen::Matrix3Xd& gap,
           estimation::RowMatrix* J_gap_x = nullptr) const;

  // Joints x poses. `near`: start of the search, one column for all poses or one each; a pose
  // starts where the one before ended when there is one column.
  Eigen::MatrixXd Readings(const LinkageRun& run, const Eigen::VectorXd& x,
                           const Eigen::MatrixXd& near) const;

  static constexpr Eigen::Index kBase = 6;  // parameters of the base

 private:
  struct Amounts;  // of the effects of one stage
  Amounts Sum(Stage stage, const LinkageRun& run, const Eigen::VectorXd& x, bool slopes) const;
  void Check(const Eigen::VectorXd& x) const;

  machine::Chain chain_;
  geometry::Transform<double> X_MB_;
  relm::LinkageModel model_;
  std::vector<std::shared_ptr<const Effect>> effects_;
  std::vector<Eigen::Index> sizes_;  // of the effects' blocks
  Eigen::Index parameters_;
};

}  // namespace abbe::simulation
