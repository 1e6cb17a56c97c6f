// The one interface of all error models of the linkage: names, priors, ball positions, derivatives.
// Estimators, simulations and reports use it without knowing which model it is.
//
//   const LinkageModel model = MakeLinkageModel(settings, ErrorModel::kComplete);
//   for (const auto& block : model.blocks()) problem.Add(block);
//   model.Tips(readings, x, tips, &J_tip_x);       // x: all entries of all blocks, in order
//
// Frames: B, the nominal linkage base; T, the ball centre. The pose X_MB of the base is not part of
// a model: it belongs to the run.
// Units: m, rad, K. Shapes: tips 3 x poses; the Jacobian by the parameters has the rows x, y, z of
// pose 0, then those of pose 1, ... and one column per parameter.
// Failure: InputError when the number of angles or parameters does not fit. Evaluation never fails:
// an angle that is not finite gives a tip that is not finite (tip_path.h checks recordings
// beforehand).
// Source: docs/theory-linkage.md.
// Validity: exact kinematics; every effect is linear in its parameter before it enters the
// geometry.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "estimation/parameter.h"
#include "estimation/residual.h"
#include "relm/motion_chain.h"

namespace abbe::relm {

using estimation::RowMatrix;

// The encoder angles of some poses, one column each, and the temperature of the links above the
// reference (empty: zero).
struct LinkageReadings {
  Eigen::MatrixXd angles;  // joints x poses, rad
  Eigen::VectorXd warmth;  // K
  Eigen::Index poses() const { return angles.cols(); }
};

struct TipDerivatives {
  Eigen::Vector3d tip;  // p_BT, m
  RowMatrix J_tip_x;    // 3 x parameters
  RowMatrix J_tip_q;    // 3 x joints, with respect to the encoder angles
};

class LinkageModel {
 public:
  // The blocks hold the parameters of `motions`, in the same order.
  LinkageModel(std::string name, MotionChain motions,
               std::vector<estimation::ParameterBlock> blocks);

  const std::string& name() const { return name_; }  // for reports: "complete"
  const std::vector<estimation::ParameterBlock>& blocks() const { return blocks_; }
  const SerialChain& chain() const { return motions_.chain(); }  // without errors
  Eigen::Index joints() const { return chain().joints(); }
  Eigen::Index parameters() const { return motions_.parameters(); }
  // The chain as `x` makes it: joint lines and ball at zero angles, in B.
  SerialChain ChainAt(const Eigen::VectorXd& x) const;
  Eigen::VectorXd Values() const;          // x of the blocks; nominal at first
  std::vector<std::string> Names() const;  // "block.entry", in the order of x

  // One pose; `warmth`: K above the reference temperature.
  Eigen::Vector3d Tip(const Eigen::VectorXd& angles, double warmth, const Eigen::VectorXd& x) const;
  // One pose, exact.
  TipDerivatives Differentiate(const Eigen::VectorXd& angles, double warmth,
                               const Eigen::VectorXd& x) const;
  // For automatic differentiation: pointers to joints() angles and parameters() values.
  template <typename T>
  Eigen::Vector3<T> Tip(const T* angles, const T& warmth, const T* x) const {
    return motions_.Tip(angles, warmth, x);
  }

  // All poses at once; `jacobian` (3 poses x parameters) may be null. Outputs are resized.
  void Tips(const LinkageReadings& readings, const Eigen::VectorXd& x, Eigen::Matrix3Xd& tips,
            RowMatrix* jacobian = nullptr) const;

 private:
  void Check(Eigen::Index angles, Eigen::Index parameters) const;

  std::string name_;
  MotionChain motions_;
  std::vector<estimation::ParameterBlock> blocks_;
};

}  // namespace abbe::relm
