#include "machine/volumetric_model.h"

#include <fmt/format.h>

#include <utility>

#include "failure/failure.h"
#include "machine/volumetric_field.h"
#include "machine/volumetric_jacobian.h"

namespace abbe::machine {
namespace {

using Eigen::Vector3d;

void RefuseUnknownMotion(int axis, int motion) {
  if (axis >= 0 && axis < kAxes && motion >= 0 && motion < kMotions) return;
  throw InputError(
      fmt::format("motion {} of axis {} does not exist: axes are 0 to 2, motions 0 to "
                  "5",
                  motion, axis));
}

}  // namespace

VolumetricModel::VolumetricModel(Chain chain, const std::array<Travel, kAxes>& travels)
    : chain_(std::move(chain)), travels_(travels) {}

const ErrorFunction& VolumetricModel::Function(int axis, int motion) const {
  RefuseUnknownMotion(axis, motion);
  return functions_[axis][motion];
}

void VolumetricModel::SetForm(int axis, int motion, SharedForm form, Gauge gauge) {
  RefuseUnknownMotion(axis, motion);
  functions_[axis][motion] = ErrorFunction(axis, motion, std::move(form), travels_[axis], gauge);
}

void VolumetricModel::SetCoefficients(int axis, int motion, const Eigen::VectorXd& coefficients) {
  RefuseUnknownMotion(axis, motion);
  functions_[axis][motion].SetCoefficients(coefficients);
}

Eigen::Index VolumetricModel::ParameterCount() const {
  Eigen::Index count = 3;
  for (const auto& functions : functions_) {
    for (const ErrorFunction& function : functions) count += function.size();
  }
  return count;
}

Eigen::VectorXd VolumetricModel::Parameters() const {
  Eigen::VectorXd parameters(ParameterCount());
  Eigen::Index at = 0;
  for (const auto& functions : functions_) {
    for (const ErrorFunction& function : functions) {
      parameters.segment(at, function.size()) = function.coefficients();
      at += function.size();
    }
  }
  parameters.tail<3>() = squareness_;
  return parameters;
}

void VolumetricModel::SetParameters(const Eigen::Ref<const Eigen::VectorXd>& parameters) {
  if (parameters.size() != ParameterCount()) {
    throw InputError(fmt::format("{} parameters for a machine error model that has {}",
                                 parameters.size(), ParameterCount()));
  }
  if (!parameters.allFinite()) {
    throw InputError("a parameter of the machine error model is not a finite number");
  }
  Eigen::Index at = 0;
  for (auto& functions : functions_) {
    for (ErrorFunction& function : functions) {
      function.SetCoefficients(parameters.segment(at, function.size()));
      at += function.size();
    }
  }
  squareness_ = parameters.tail<3>();
}

std::vector<estimation::ParameterBlock> VolumetricModel::Blocks() const {
  using estimation::kMicrometres, estimation::kMicroradians;
  std::vector<estimation::ParameterBlock> blocks;
  for (int axis = 0; axis < kAxes; ++axis) {
    for (int motion = 0; motion < kMotions; ++motion) {
      const Eigen::VectorXd& c = functions_[axis][motion].coefficients();
      if (c.size() == 0) continue;
      estimation::ParameterBlock block(MotionName(axis, motion),
                                       motion < 3 ? kMicrometres : kMicroradians, {});
      for (Eigen::Index i = 0; i < c.size(); ++i) {
        block.entries.push_back({.name = fmt::format("c{}", i), .value = c[i]});
      }
      blocks.push_back(std::move(block));
    }
  }
  blocks.push_back({"squareness",
                    kMicroradians,
                    {{.name = "A0Z", .value = squareness_.x()},
                     {.name = "B0Z", .value = squareness_.y()},
                     {.name = "C0Y", .value = squareness_.z()}}});
  return blocks;
}

void VolumetricModel::RefuseOutside(const Vector3d& position) const {
  for (int axis = 0; axis < kAxes; ++axis) InTravel(travels_[axis], axis, position[axis]);
}

MotionErrors<double> VolumetricModel::Motions(const Vector3d& position) const {
  RefuseOutside(position);
  MotionErrors<double> errors;
  for (int axis = 0; axis < kAxes; ++axis) {
    for (int motion = 0; motion < kMotions; ++motion) {
      errors.axes[axis][motion] = functions_[axis][motion].Evaluate(position[axis]);
    }
  }
  errors.squareness = squareness_;
  return errors;
}

Vector3d VolumetricModel::Error(const Vector3d& position, const Vector3d& p_TQ) const {
  return VolumetricError<double>(chain_, position, p_TQ, Motions(position));
}

Eigen::Matrix3Xd VolumetricModel::Errors(const Eigen::Matrix3Xd& positions,
                                         const Vector3d& p_TQ) const {
  return VolumetricField(*this).Errors(positions, p_TQ);
}

VolumetricModel::Linearized VolumetricModel::Linearize(const Vector3d& position,
                                                       const Vector3d& p_TQ) const {
  RefuseOutside(position);
  MotionErrors<double> motions;
  motions.squareness = squareness_;
  Eigen::VectorXd gradient(ParameterCount());
  Eigen::Matrix<double, kMotions, kAxes> slopes;
  Eigen::Index at = 0;
  for (int axis = 0; axis < kAxes; ++axis) {
    for (int motion = 0; motion < kMotions; ++motion) {
      const ErrorFunction& function = functions_[axis][motion];
      motions.axes[axis][motion] =
          function.Evaluate(position[axis], &slopes(motion, axis), gradient.data() + at);
      at += function.size();
    }
  }
  const VolumetricJacobian J = VolumetricErrorAndJacobian(chain_, position, p_TQ, motions);
  Linearized result{J.error, Eigen::Matrix3Xd(3, ParameterCount()), J.J_error_position,
                    J.J_error_tool};
  at = 0;
  for (int axis = 0; axis < kAxes; ++axis) {
    for (int motion = 0; motion < kMotions; ++motion) {
      const int n = functions_[axis][motion].size();
      const Vector3d by_motion = J.J_error_motions.col(kMotions * axis + motion);
      result.J_error_parameters.middleCols(at, n) = by_motion * gradient.segment(at, n).transpose();
      result.J_error_position.col(axis) += slopes(motion, axis) * by_motion;
      at += n;
    }
  }
  result.J_error_parameters.rightCols<3>() = J.J_error_squareness;
  return result;
}

}  // namespace abbe::machine
