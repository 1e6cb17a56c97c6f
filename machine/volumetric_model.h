// The machine error model: a chain, 18 error functions, three squarenesses.
//
//   VolumetricModel model(mill.chain, mill.travels);               // a perfect machine
//   const auto form = MakeBSplineForm(geometry::BSplineBasis::Uniform(3, 0.0, 0.06, 8));
//   model.SetForm(0, 4, form);                                     // EBX
//   model.SetParameters(p);
//   const Eigen::Vector3d error = model.Error({0.03, 0.02, 0.05}, p_TQ);
//
// Parameters: the coefficients of the functions, axis by axis in the order of error_motion.h, then
// A0Z, B0Z, C0Y. Blocks() returns them as named blocks of an estimation: block "EBX", entries "c0",
// "c1" ...; block "squareness".
// Frames, signs, tool vector: volumetric_error.h. Gauge: error_function.h.
// Units: SI. Shapes: positions in columns, 3 x N.
// Failure: InputError for a position outside a travel, naming axis and travel, for an axis or
// motion that does not exist, and for parameters of the wrong number or not finite.
// Threads: several may evaluate at once, but not while one changes the model.
// Source: docs/theory-volumetric.md; the error is that of volumetric_error.h with the functions of
// error_function.h.
// Validity: rigid bodies; each motion depends on the position of its own axis only, not on
// temperature or load.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "estimation/parameter.h"
#include "machine/error_function.h"
#include "machine/volumetric_error.h"

namespace abbe::machine {

class VolumetricModel {
 public:
  VolumetricModel(Chain chain, const std::array<Travel, kAxes>& travels);

  const Chain& chain() const { return chain_; }
  const std::array<Travel, kAxes>& travels() const { return travels_; }
  // The function of a motion (0 to 5) of an axis (0 to 2).
  const ErrorFunction& Function(int axis, int motion) const;
  const Eigen::Vector3d& squareness() const { return squareness_; }  // [A0Z B0Z C0Y], rad

  // The form of one function, with its gauge and all coefficients 0.
  void SetForm(int axis, int motion, SharedForm form, Gauge gauge = Gauge::kZeroAtStart);
  // One function; the others stay.
  void SetCoefficients(int axis, int motion, const Eigen::VectorXd& coefficients);
  // [A0Z B0Z C0Y], rad.
  void SetSquareness(const Eigen::Vector3d& squareness) { squareness_ = squareness; }

  // Coefficients of all functions and the three squarenesses.
  Eigen::Index ParameterCount() const;
  // P x 1, in the order above.
  Eigen::VectorXd Parameters() const;
  // The same order.
  void SetParameters(const Eigen::Ref<const Eigen::VectorXd>& parameters);
  // Values as they are; no priors.
  std::vector<estimation::ParameterBlock> Blocks() const;

  // The 18 motions and the squarenesses at a position.
  MotionErrors<double> Motions(const Eigen::Vector3d& position) const;
  // Actual minus nominal in W.
  Eigen::Vector3d Error(const Eigen::Vector3d& position, const Eigen::Vector3d& p_TQ) const;
  // One column for each of `positions`.
  Eigen::Matrix3Xd Errors(const Eigen::Matrix3Xd& positions, const Eigen::Vector3d& p_TQ) const;

  struct Linearized {
    Eigen::Vector3d error;
    Eigen::Matrix3Xd J_error_parameters;
    Eigen::Matrix3d J_error_position;  // with the slopes of the error functions
    Eigen::Matrix3d J_error_tool;
  };
  // The error with its derivatives by parameters (3 x P), position and tool.
  Linearized Linearize(const Eigen::Vector3d& position, const Eigen::Vector3d& p_TQ) const;

 private:
  void RefuseOutside(const Eigen::Vector3d& position) const;

  Chain chain_;
  std::array<Travel, kAxes> travels_;
  std::array<std::array<ErrorFunction, kMotions>, kAxes> functions_;
  Eigen::Vector3d squareness_ = Eigen::Vector3d::Zero();
};

}  // namespace abbe::machine
