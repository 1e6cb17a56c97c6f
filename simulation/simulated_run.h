// A run together with its simulation, ready to be fitted: what the estimator in fusion/ takes.
//
//   for (const SimulatedRun& run : runs) AddToProblem(run);      // fusion/machine_problem.h
//
// The residual is whitened: measured minus simulated reading, of standard deviation 1. Its x are
// the entries of `blocks`, one block after the other. Blocks are shared by name: the functions of
// the machine by all runs, the probes by all sweeps, the target by the sweeps of one mounting.
// A new kind of run is a new file that makes one of these.
//
// A run that wants a first fit gives `condense`: called with its x, it makes the residual of the
// fit that counts. So a run of more rows than a fit wants to see starts with a sample of them.
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

// Beyond so many standard deviations a row of a run with single readings pulls no more; costs
// normal data 0.1 %.
inline constexpr double kPullsNoMore = 3.0;

// What disturbances of the rows do to what is simulated, to first order at one x.
class Response {
 public:
  virtual ~Response() = default;

  // Whitened, rows of the residual x disturbances: residual(with them) = residual - sum of columns.
  virtual Eigen::MatrixXd Columns(const std::vector<Disturbance>& disturbances) const = 0;
  // What the instrument would show without noise, readings x rows of the run (gaps, m; angles,
  // rad), when `left` is what the simulation leaves, whitened. A disturbance made of readings
  // themselves would share their noise.
  virtual Eigen::MatrixXd Readings(const Eigen::VectorXd& left) const = 0;
  // For many functions of one stage: the score of a disturbance d is scores * d', and its
  // information at most weights * d^2'.
  struct RowScores {
    Eigen::RowVectorXd scores, weights;
  };
  virtual RowScores ScoresOf(Eigen::Index stage, const Eigen::VectorXd& left) const = 0;
};

// A residual that also tells what a disturbance of its rows does.
class Responsive : public estimation::Residual {
 public:
  virtual std::shared_ptr<const Response> At(const Eigen::VectorXd& x) const = 0;
};

struct SimulatedRun {
  std::string name;  // of the recording
  std::string kind;  // "sweep", "linkage", "reference", "length", "plate"
  std::vector<estimation::ParameterBlock> blocks;
  std::shared_ptr<const estimation::Residual> residual;
  estimation::RobustLoss loss = estimation::RobustLoss::None();
  std::shared_ptr<const Responsive> response = nullptr;  // `residual` itself, where it can tell
  std::function<std::shared_ptr<const estimation::Residual>(const Eigen::VectorXd& x)> condense =
      {};
};

}  // namespace abbe::simulation
