// The probability of what the runs say of the functions, for given sizes and correlation lengths,
// and its slopes: the equations of population_estimate.h.
//
//   const PopulationEvidence evidence(machine, model);
//   const auto now = evidence.At(of_machine, theta);
//   const auto local = evidence.SlopesAt(of_machine, theta, now);
//
// theta: logarithms over what the machine file says, of waves over what is usual.
// Units: SI. Shapes: theta: of each function its size, then its length; then of the squarenesses
// and of the slopes of the positioning errors; where the model holds waves, their size and length
// for each axis, over what is usual. Failure: none.
// Source: Rasmussen and Williams (2006), 5.4.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <array>
#include <functional>
#include <string_view>
#include <vector>

#include "fusion/machine_prior.h"

namespace abbe::fusion {

inline constexpr std::string_view kSmoothnessKey = "population.smoothness_mm";

// A line of the machine file and what the runs say of it.
struct Statement {
  std::string_view key;  // "population.smoothness_mm"
  double unit;           // of the key, SI
  double stated;         // SI
  double seen = 0.0;     // SI
  double u_log = 0.0;    // of the logarithm of `seen`; infinite: the runs do not tell
  // Off by more than its uncertainty explains, and by more than a third.
  bool Refuted() const;
};

// The lines of [population]; each size belongs to one.
enum Line {
  kPositioning,
  kStraightness,
  kRoll,
  kPitch,
  kYaw,
  kSquareness,
  kScale,
  kSmoothness,
  kLines,
  // Waves have no line in the machine file.
  kWave = kLines,
  kWaveLength
};

// How the machine file states a line.
struct LineInFile {
  std::string_view key;  // "population.smoothness_mm"
  double unit;
  double machine::Population::*value;
};
// In the order of Line.
const std::array<LineInFile, kLines>& LinesInFile();

// One of theta.
struct Knob {
  Line line;
  int axis, motion;  // of the function; -1: of none alone
};

// H and h of the functions and squarenesses, or the same of all parameters.
struct Quadratic {
  Eigen::MatrixXd information;
  Eigen::VectorXd vector;
  double log = 0.0;  // of the evidence: what marginalising the others contributes
};

// H and h of the columns `of_machine`, marginalised over all others that have any information.
Quadratic Marginalised(const Quadratic& all, const std::vector<int>& of_machine);

// A finding is named where the logarithm of the evidence gains so much: odds of 22 000 : 1.
inline constexpr double kEvident = 10.0;

class PopulationEvidence {
 public:
  PopulationEvidence(const machine::Machine& machine, const machine::VolumetricModel& model);

  const std::vector<Knob>& knobs() const { return knobs_; }
  Eigen::Index count() const { return knobs_.size(); }
  // Whether one of theta is a correlation length.
  bool IsLength(Eigen::Index knob) const { return knobs_[knob].line == kSmoothness; }
  Eigen::Index squareness() const { return squareness_; }   // where the squarenesses begin
  const Eigen::MatrixXd& precision() const { return pi_; }  // Pi: of the prior of theta

  // Sizes and lengths by theta.
  ErrorPopulation PopulationAt(const Eigen::VectorXd& theta) const;
  // L with L L' = V but for what a function hardly does; a column of zeros for each of that.
  Eigen::MatrixXd FactorAt(const Eigen::VectorXd& theta) const;

  struct Evidence {
    double log = 0.0;  // log Z with the prior of theta
    Eigen::MatrixXd HL;
    Eigen::LLT<Eigen::MatrixXd> factor;  // of 1 + L' H L
    Eigen::VectorXd b;
    // A = (V + H^-1)^-1 = H - H L (1 + L' H L)^-1 L' H
    Eigen::MatrixXd A(const Eigen::MatrixXd& H) const;
  };
  // At theta, with those columns of L that are not zero; `b`: h - H C h.
  Evidence At(const Quadratic& of_machine, const Eigen::VectorXd& theta) const;

  struct Slopes {
    Eigen::VectorXd gradient;  // of log Z without the prior of theta
    Eigen::MatrixXd fisher;    // F
  };
  // By theta, where `evidence` is that of `theta`.
  Slopes SlopesAt(const Quadratic& of_machine, const Eigen::VectorXd& theta,
                  const Evidence& evidence) const;

  // Knobs of functions; those of the squarenesses and of the slopes follow.
  Eigen::Index of_functions() const { return count() - 2 - waves_; }
  struct Maximum {
    Eigen::VectorXd theta;
    double log = 0.0;  // log Z with the prior of theta
    Slopes local;      // of the last step
  };
  // From `theta` on, of which the first `free` are free and the others stay.
  Maximum Maximise(const Quadratic& of_machine, const Eigen::VectorXd& theta,
                   Eigen::Index free) const;
  // The axes without whose waves the logarithm of the evidence falls by kEvident or more, the sizes
  // and lengths of the smooth errors chosen anew.
  std::array<bool, machine::kAxes> EvidentWaves(const Quadratic& of_machine,
                                                const Eigen::VectorXd& theta) const;
  // The most probable of several common lengths, all sizes as stated.
  Eigen::VectorXd AtBestLength(const Quadratic& of_machine) const;
  // Each line that its errors share, with all lines free: each weighted by what the runs tell.
  std::vector<Statement> Statements(const Maximum& at) const;

  // How the estimates move with theta of covariance `cov`, to first order (I - V A) V_i b: columns
  // that are independent of each other, of one standard deviation.
  Eigen::MatrixXd MovedByTheta(const Quadratic& of_machine, const Eigen::VectorXd& theta,
                               const Eigen::MatrixXd& cov) const;

 private:
  // The slope of V by one of theta, in one block of it.
  struct Part {
    Eigen::Index knob, at;
    Eigen::MatrixXd slope;
  };
  std::vector<Part> Parts(const Eigen::VectorXd& theta) const;
  // `wave`: the knob of its size.
  bool IsEvident(const Quadratic& of_machine, const Eigen::VectorXd& theta,
                 Eigen::Index wave) const;
  // Calls it with the first column and the size of each function, then of the squarenesses.
  void EachBlock(const std::function<void(Eigen::Index, Eigen::Index)>& of_block) const;

  const machine::Machine& machine_;
  const machine::VolumetricModel& model_;
  const MachinePrior stated_;
  std::vector<Knob> knobs_;
  std::array<std::array<Eigen::Index, machine::kMotions>, machine::kAxes> first_{};
  Eigen::Index squareness_ = 0;
  Eigen::Index waves_ = 0;  // knobs of waves, the last ones
  Eigen::MatrixXd pi_;
};

}  // namespace abbe::fusion
