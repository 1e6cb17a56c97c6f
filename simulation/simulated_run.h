// A run together with its simulation, ready to be fitted: what the estimator in fusion/ takes.
//
//   const std::vector<SimulatedRun> runs{SimulateSweep(model, reference, instrument, sweep)};
//   estimation::Problem problem = fusion::MakeMachineProblem(mill, model, prior, runs);
//
// The residual is whitened: measured minus simulated reading, of standard deviation 1. Its x are
// the entries of `blocks`, one block after the other. Blocks are shared by name: the functions of
// the machine by all runs, the probes by all sweeps, the target by the sweeps of one mounting.
// Each kind of run makes these (run_kind.h).
//
// A run that takes two fits (too many rows for one, or noise in the angles of a linkage) gives
// `condense`: called with the x of the first fit, it returns the residual of the second.
// Units: residuals in standard deviations; disturbances as their stage says. Shapes: as each member
// says.
// Failure: that of the kind that makes it.
// Source: docs/theory-fusion.md has the residual of each kind.
// Validity: a response is first order at its x.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "estimation/parameter.h"
#include "estimation/residual.h"
#include "estimation/robust_loss.h"
#include "simulation/disturbance.h"

namespace abbe::simulation {

// Huber threshold of single readings, in standard deviations; efficiency loss on normal data 0.1 %.
inline constexpr double kHuberThreshold = 3.0;

// How disturbances of the rows change the simulated readings: to first order, at one x.
class Response {
 public:
  virtual ~Response() = default;

  // Whitened, rows of the residual x disturbances: residual(with them) = residual - sum of columns.
  virtual Eigen::MatrixXd Columns(const std::vector<Disturbance>& disturbances) const = 0;
  // What the instrument would show without noise: readings x rows of the run (gaps, m; angles,
  // rad). `left`: the whitened residual. A cause that depends on the reading uses these; the
  // recorded ones would give it their noise.
  virtual Eigen::MatrixXd Readings(const Eigen::VectorXd& left) const = 0;
  // The tilt of the face against each probe, rad, probes x rows of the run; empty without probes.
  virtual Eigen::MatrixXd Tilts() const { return {}; }
  // The adjoint of Columns, in two steps, for many disturbances against the same rows:
  //   Columns({d})' left = sum over the stages of d.row(stage) * BackToStage(stage, back)'
  // with back = BackToReadings(left), `left` whitened, rows of the residual x anything.
  virtual Eigen::MatrixXd BackToReadings(const Eigen::MatrixXd& left) const = 0;
  virtual Eigen::MatrixXd BackToStage(Eigen::Index stage, const Eigen::MatrixXd& back) const = 0;
  // What each row tells of a disturbance of one stage, all other rows known. Where the noise of the
  // rows is independent, the information of a disturbance d is WeightsOf(stage) * d^2'.
  virtual Eigen::RowVectorXd WeightsOf(Eigen::Index stage) const = 0;
  virtual bool RowsAreIndependent() const = 0;
};

// A residual that also tells what a disturbance of its rows does.
class Responsive : public estimation::Residual {
 public:
  // Linearised at x.
  virtual std::shared_ptr<const Response> At(const Eigen::VectorXd& x) const = 0;
};

// A run whose noise does not contain the form of the target: its residual has that as the last of
// its parameters, one block for each place of the faces, which all sweeps of an axis share.
struct FormApart {
  std::vector<estimation::ParameterBlock> blocks;
  std::shared_ptr<const estimation::Residual> residual;
  std::shared_ptr<const Responsive> response;
};

struct SimulatedRun {
  std::string name;  // of the recording
  std::string kind;  // how a report calls it: "sweep"
  std::vector<estimation::ParameterBlock> blocks;
  std::shared_ptr<const estimation::Residual> residual;
  estimation::RobustLoss loss = estimation::RobustLoss::None();
  std::shared_ptr<const Responsive> response = nullptr;  // `residual` itself, where it can tell
  // Which way each axis last moved in each row: +1, -1, 0 where nobody knows; 3 x rows of the run.
  // Empty: not known.
  Eigen::Matrix3Xd heading = {};
  // Positions of the axes, m, 3 x rows of the run. Empty: not known.
  Eigen::Matrix3Xd commanded = {};
  // s, of the instants of the run in their order, each with as many rows of the residual. Empty:
  // they have no order.
  Eigen::VectorXd times = {};
  std::function<std::shared_ptr<const estimation::Residual>(const Eigen::VectorXd& x)> condense =
      {};
  // With the form of the target beside the noise, which else contains as much of it as the machine
  // file states (target.form_nm). Empty: none is stated, or the run has it apart.
  std::function<FormApart()> form_apart = {};
  double form_stated = 0.0, form_known_to = 1.0;  // m; a factor
  // The same run with the noise of two channels exchanged: noise belongs to the sensor, not to the
  // name of its channel. Empty: all channels have one noise.
  std::function<SimulatedRun(std::size_t one, std::size_t other)> noise_exchanged = {};
  // m: whitened rows as they are in space, one column for each pose; empty: rows are no places.
  std::function<Eigen::Matrix3Xd(const Eigen::VectorXd& whitened)> in_space = {};
  std::vector<std::string> notes = {};  // what was taken out of the readings, one sentence each
};

}  // namespace abbe::simulation
