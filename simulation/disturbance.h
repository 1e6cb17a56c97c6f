// What comes between a command and a reading in the rows of a run, stage by stage: the language in
// which a cause (simulation/causes/) says what it does, the same for every kind of run.
//
//   Disturbance lag = NoDisturbance(trace);
//   lag.row(MotionStage(0, 0)) = -0.5 * width * trace.heading.row(0);     // EXX
//   run.response->At(x)->Columns({lag});                  // what the run then reads differently
//
// Stages, in the order in which a command becomes a reading:
//   motion    18: added to the error motions of X, Y, Z, machine/error_motion.h       m, rad
//   tool      3: the ball against the spindle, in M as the workpiece carries it       m
//   tip       3: the ball against the linkage as it is simulated, in B                m
//   reading   5: what the probes a ... e, at a shaft sensor_1 ..., show beside the gap m
//   encoder   one for each pivot: what it shows beside its angle                      rad
// Frames: M and B, as each stage says.
// Units: m, rad, as each stage says. Shapes: one entry for each row of the run.
// Failure: none; a wrong stage is a programming error.
// Validity: disturbances are small, their products with each other and with the errors of the
// machine are left out (1e-4 of them).
#pragma once

#include <Eigen/Core>
#include <map>

#include "machine/error_motion.h"

namespace abbe::simulation {

class Disturbance {
 public:
  explicit Disturbance(Eigen::Index rows) : rows_(rows) {}

  // The values of a stage; zeros at first.
  Eigen::RowVectorXd& row(Eigen::Index stage) {
    return stages_.try_emplace(stage, Eigen::RowVectorXd::Zero(rows_)).first->second;
  }
  Eigen::Index rows() const { return rows_; }
  // Those that act.
  const std::map<Eigen::Index, Eigen::RowVectorXd>& stages() const { return stages_; }

 private:
  Eigen::Index rows_;
  std::map<Eigen::Index, Eigen::RowVectorXd> stages_;
};

inline constexpr int kToolStage = machine::kAxes * machine::kMotions;
inline constexpr int kTipStage = kToolStage + 3;
inline constexpr int kReadingStage = kTipStage + 3;
inline constexpr int kEncoderStage = kReadingStage + 5;
inline constexpr int kStages = kEncoderStage;

// `motion` 0 to 5 of `axis` 0 to 2.
constexpr int MotionStage(int axis, int motion) { return axis * machine::kMotions + motion; }

}  // namespace abbe::simulation
