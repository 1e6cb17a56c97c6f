// What a run of the linkage should read: command -> machine -> ball -> linkage -> encoders.
//
// The ball sits in the spindle and at the end of the linkage, whose base stands on the table. So
// the loop table - machine - spindle - ball - linkage - table closes, in frame M:
//
//   gap = X_MB p_BT(readings) - p_MT(reference) = 0
//
// This one equation is used two ways. To fit: the gap of measured readings is what noise and wrong
// parameters leave (Gap, with derivatives). To predict: the readings that close the gap (Readings).
//
//   const auto model = relm::MakeLinkageModel(linkage, relm::ErrorModel::kComplete);
//   const LinkageSimulation simulation(chain, linkage, model);
//   const Eigen::MatrixXd angles = simulation.Readings(run, simulation.Values());
//
// Noise of the encoders reaches the gap through the pose, noise of the reference directly:
// cov(gap) = R J_tip_q (s_encoder^2 / samples) J_tip_q' R' + diag(s_reference^2); GapNoise.
//
// Frames: M, the machine frame as the workpiece carries it; B, the linkage base; T, the ball. X_MB
// = nominal pose, then shifted by [x y z] in M and turned by exp([a b c]) in B.
// Units: m, rad. Shapes: x is [base: x y z | base_turn: a b c | blocks of the model]; gaps 3 x
// poses, the Jacobian has rows x, y, z of pose 0, then of pose 1, ...
// Failure: InputError when x has the wrong size; Readings throws NumericalError with the run, the
// row and the position of a pose that the linkage does not reach.
// Source: docs/theory-linkage.md; the loop is the project's.
// Validity: exact kinematics; the machine is as good as the stated deviation of the reference.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "estimation/parameter.h"
#include "estimation/residual.h"
#include "geometry/transform.h"
#include "machine/chain.h"
#include "relm/linkage_settings.h"
#include "simulation/linkage/linkage_run.h"

namespace abbe::simulation {

using Vector6 = Eigen::Matrix<double, 6, 1>;

// The base at [x y z a b c] off its nominal pose.
geometry::Transform<double> BaseAt(const geometry::Transform<double>& nominal_X_MB,
                                   const Vector6& offset);

// d p_MT / d x of each pose from the model's own derivatives: rows as in Gap.
void JacobianInMachine(const geometry::Transform<double>& nominal_X_MB, const Eigen::VectorXd& x,
                       const Eigen::Matrix3Xd& p_BT, const estimation::RowMatrix& J_tip_x,
                       estimation::RowMatrix& J);

// Names of the blocks of the base of a mounting: position [x y z] in M, turn [a b c] in B.
std::string BaseBlock(const std::string& mounting);
// "base_turn", with the name of the mounting where it has one.
std::string BaseTurnBlock(const std::string& mounting);

// The blocks "base" [x y z] and "base_turn" [a b c] with the priors of the machine file.
std::vector<estimation::ParameterBlock> BaseBlocks(const relm::LinkageSettings& settings);

class LinkageSimulation {
 public:
  LinkageSimulation(machine::Chain chain, relm::LinkageSettings settings, relm::LinkageModel model);

  const machine::Chain& chain() const { return chain_; }
  const relm::LinkageModel& model() const { return model_; }
  const relm::LinkageSettings& settings() const { return settings_; }
  Eigen::Index parameters() const { return kBase + model_.parameters(); }
  Eigen::VectorXd Values() const;  // nominal base, the model's values
  // The parameters of the base, then of the model.
  std::vector<estimation::ParameterBlock> Blocks() const;

  // Where the reference says that the ball stands, p_MT.
  Eigen::Matrix3Xd Ball(const LinkageRun& run) const;

  // 3 x poses; the Jacobian 3 poses x parameters.
  void Gap(const LinkageRun& run, const Eigen::VectorXd& x, Eigen::Matrix3Xd& gap,
           estimation::RowMatrix* J_gap_x = nullptr) const;

  // The lower Cholesky factors of cov(gap), one 3 x 3 block of columns per pose, at the nominal
  // parameters (an error of 1 mrad changes them by 0.1 %). InputError when a pose has no noise.
  Eigen::Matrix3Xd GapNoise(const LinkageRun& run) const;

  // What the encoders would say, joints x poses. The search starts at the nominal angles, or for a
  // chain without closed form at `near`, and then where the pose before ended.
  Eigen::MatrixXd Readings(const LinkageRun& run, const Eigen::VectorXd& x,
                           const Eigen::VectorXd& near = {}) const;

  static constexpr Eigen::Index kBase = 6;  // parameters of the base

 private:
  void Check(const Eigen::VectorXd& x) const;
  // Newton steps on `q` until the ball is met; returns what is left, m.
  double Close(const Eigen::Vector3d& p_BT, double warmth, const Eigen::VectorXd& values,
               Eigen::VectorXd& q) const;
  Eigen::VectorXd Start(const Eigen::Vector3d& p_BT, const Eigen::VectorXd& near) const;

  machine::Chain chain_;
  relm::LinkageSettings settings_;
  relm::LinkageModel model_;
};

}  // namespace abbe::simulation
