// The seam through which physics joins the simulated measurement of the linkage: machine errors,
// and the causes that a diagnosis adds.
//
// The measurement runs through stages, and an effect acts at one of them:
//
//   kMotion    adds to where the ball stands in M when the axes are sent to a position, m
//   kEncoder   adds to what the encoders say when the pivots stand at an angle, rad
//
// What is part of the linkage itself (geometry, bearings, gravity, warmth) is in the linkage's
// error model (relm/linkage_model.h). An effect has one block of parameters, zero (or at their
// nominal values) when it is absent.
// Shapes: `amounts` 3 x poses at kMotion, joints x poses at kEncoder; the Jacobian has the rows of
// pose 0, then those of pose 1, ... and one column per parameter of the block. It is zero before
// and may be null. Failure: NumericalError outside the effect's domain.
#pragma once

#include <Eigen/Core>

#include "estimation/parameter.h"
#include "estimation/residual.h"
#include "simulation/linkage_run.h"

namespace abbe::simulation {

enum class Stage { kMotion, kEncoder };

class Effect {
 public:
  virtual ~Effect() = default;
  virtual Stage stage() const = 0;
  virtual estimation::ParameterBlock Block() const = 0;
  virtual void Add(const LinkageRun& run, const Eigen::VectorXd& x, Eigen::MatrixXd& amounts,
                   estimation::RowMatrix* jacobian) const = 0;
};

// Each encoder counts (1 + gain) times the true angle: wrong counts per turn, -2 for a wrong sense.
class EncoderGain : public Effect {
 public:
  explicit EncoderGain(Eigen::Index joints) : joints_(joints) {}
  Stage stage() const override { return Stage::kEncoder; }
  estimation::ParameterBlock Block() const override;  // encoder_gain: pivot_1 ...
  void Add(const LinkageRun& run, const Eigen::VectorXd& x, Eigen::MatrixXd& amounts,
           estimation::RowMatrix* jacobian) const override;

 private:
  Eigen::Index joints_;
};

}  // namespace abbe::simulation
