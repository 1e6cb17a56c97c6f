#include "fusion/encoder_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "estimation/problem.h"
#include "failure/failure.h"
#include "geometry/rotation.h"
#include "simulation/linkage/linkage_problem.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using estimation::ParameterBlock;
using simulation::LinkageSimulation;

// x = [base | base_turn | offset of each encoder | gain of each encoder]: the nominal chain at
// (1 + gain) angle + offset.
class NominalGap : public estimation::Residual {
 public:
  NominalGap(const LinkageSimulation& simulation, Matrix3Xd p_MT, MatrixXd angles)
      : chain_(simulation.model().chain()),
        X_MB_(simulation.settings().X_MB),
        p_MT_(std::move(p_MT)),
        angles_(std::move(angles)) {}

  Index Rows() const override { return p_MT_.size(); }

  void Evaluate(const VectorXd& x, VectorXd& values,
                estimation::RowMatrix* jacobian) const override {
    const Index n = chain_.joints();
    const auto X_MB = simulation::BaseAt(X_MB_, x.head<6>());
    Matrix3Xd p_BT(3, p_MT_.cols());
    estimation::RowMatrix J_tip_x(jacobian == nullptr ? 0 : p_MT_.size(), 2 * n);
    for (Index pose = 0; pose < p_MT_.cols(); ++pose) {
      const VectorXd q =
          angles_.col(pose).cwiseProduct((x.tail(n).array() + 1.0).matrix()) + x.segment(6, n);
      p_BT.col(pose) = chain_.Tip(q);
      values.segment<3>(3 * pose) = X_MB * Vector3d(p_BT.col(pose)) - p_MT_.col(pose);
      if (jacobian == nullptr) continue;
      const Matrix3Xd J_tip_q = chain_.JacobianTipAngles(q);
      J_tip_x.block(3 * pose, 0, 3, n) = J_tip_q;
      J_tip_x.block(3 * pose, n, 3, n) = J_tip_q * angles_.col(pose).asDiagonal();
    }
    if (jacobian != nullptr) simulation::JacobianInMachine(X_MB_, x, p_BT, J_tip_x, *jacobian);
  }

 private:
  relm::SerialChain chain_;
  geometry::Transform<double> X_MB_;
  Matrix3Xd p_MT_;
  MatrixXd angles_;
};

struct Assumption {
  double rms = 0.0;  // m
  VectorXd gains;
};

ParameterBlock PerEncoder(const std::string& name, Index joints, double sd) {
  ParameterBlock block(name, {}, {});
  for (Index i = 0; i < joints; ++i) {
    block.entries.push_back({.name = fmt::format("pivot_{}", i + 1), .prior_sd = sd});
  }
  return block;
}

constexpr double kAnyAngle = 1.0;   // rad, and of gains: wide priors
constexpr double kSpread = 1e-4;    // m: gap that the tolerances of a linkage explain
constexpr double kLeftOver = 5e-3;  // of the reach: a larger gap is no explanation
constexpr double kReversed = -2.0;  // gain of an encoder of the other sense

std::optional<Assumption> FitAssuming(const LinkageSimulation& simulation, const Matrix3Xd& p_MT,
                                      const MatrixXd& angles, bool with_gains,
                                      double start_gain = 0.0, Index started = 0) {
  const Index n = angles.rows();
  auto blocks = simulation::BaseBlocks(simulation.settings());
  blocks.push_back(PerEncoder("offset", n, kAnyAngle));
  blocks.push_back(PerEncoder("gain", n, kAnyAngle));
  blocks.back().entries[started].value = start_gain;
  if (!with_gains) blocks.back().Hold();
  estimation::Problem problem;
  std::vector<estimation::Input> inputs;
  inputs.reserve(blocks.size());
  for (auto& block : blocks) inputs.emplace_back(problem.Add(block));
  const auto source = problem.AddSource("gaps");
  const auto residual = std::make_shared<NominalGap>(simulation, p_MT, angles);
  problem.Add(source, residual, inputs, kSpread);
  try {
    const auto result = simulation::SolveLinkage(problem);
    const auto& gap = result.Source("gaps");
    return Assumption{kSpread * gap.rms * std::sqrt(3.0), result.Block("gain").Values()};
  } catch (const NumericalError&) {
    return std::nullopt;  // the assumption does not hold
  }
}

struct Finding {
  double rms;  // m
  std::string what, advice;
};

std::vector<Finding> Swaps(const LinkageSimulation& simulation, const Matrix3Xd& p_MT,
                           const MatrixXd& angles) {
  std::vector<Finding> findings;
  for (Index i = 0; i < angles.rows(); ++i) {
    for (Index j = i + 1; j < angles.rows(); ++j) {
      MatrixXd swapped = angles;
      swapped.row(i).swap(swapped.row(j));
      const auto fit = FitAssuming(simulation, p_MT, swapped, false);
      if (!fit) continue;
      findings.push_back(
          {fit->rms, fmt::format("the encoders of pivot_{} and pivot_{} are swapped", i + 1, j + 1),
           "exchange their node ids in [devices.linkage]"});
    }
  }
  return findings;
}

Finding FromGains(const Assumption& fit) {
  Index worst = 0;
  fit.gains.cwiseAbs().maxCoeff(&worst);
  const double scale = 1.0 + fit.gains[worst];
  if (scale < 0.0) {
    return {fit.rms, fmt::format("the encoder of pivot_{} counts in the other sense", worst + 1),
            "change the sign of its node in [devices.linkage]"};
  }
  return {fit.rms,
          fmt::format("the encoder of pivot_{} turns {:.4f} times as far as it reads", worst + 1,
                      scale),
          "correct counts_per_turn of its node in [devices.linkage]"};
}

}  // namespace

void CheckEncoders(const LinkageSimulation& simulation, const simulation::LinkageRun& run) {
  const Matrix3Xd p_MT = simulation.Ball(run);
  const MatrixXd& angles = run.readings.angles;
  const auto stated = FitAssuming(simulation, p_MT, angles, false);
  const double gap = stated ? stated->rms : std::numeric_limits<double>::infinity();
  std::vector<Finding> findings = Swaps(simulation, p_MT, angles);
  for (Index i = 0; i < angles.rows(); ++i) {
    for (const double start : {0.0, kReversed}) {
      if (const auto fit = FitAssuming(simulation, p_MT, angles, true, start, i)) {
        findings.push_back(FromGains(*fit));
      }
    }
  }
  const auto best = std::min_element(findings.begin(), findings.end(),
                                     [](const auto& a, const auto& b) { return a.rms < b.rms; });
  if (best == findings.end() || !(best->rms * kExplains < gap)) return;
  if (best->rms > kLeftOver * simulation.model().chain().Reach()) return;
  throw InputError(
      fmt::format("{}: {} (this leaves a gap of {:.3g} mm, as stated it is {:.3g} mm); {}",
                  run.name, best->what, 1e3 * best->rms, 1e3 * gap, best->advice));
}

}  // namespace abbe::fusion
