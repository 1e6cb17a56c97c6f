#include "fusion/reversals.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "estimation/extended_residual.h"
#include "machine/error_motion.h"
#include "simulation/disturbance.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using estimation::ParameterBlock;
using simulation::SimulatedRun;

constexpr double kAtFirst = 0.3;    // of the errors of the machine file
constexpr double kLeastOdds = 7.0;  // logarithm: 1000 : 1
constexpr double kBeyondChance = 3.5;
constexpr int kSmallest = -5, kLargest = 8;  // powers of two of the errors of the machine file
constexpr int kShifts = 3;                   // of the motions; the others rotate

// "reversal X" has EXX, EYX, EZX; "reversal_turn X" has EAX, EBX, ECX.
std::array<std::string, 2> BlocksOf(int axis) {
  return {std::string("reversal ") + "XYZ"[axis], std::string("reversal_turn ") + "XYZ"[axis]};
}

VectorXd DeviationsOf(const machine::Machine& machine, int axis) {
  VectorXd deviations(machine::kMotions);
  for (int motion = 0; motion < machine::kMotions; ++motion) {
    deviations[motion] = machine::PopulationDeviation(machine.population, axis, motion);
  }
  return deviations;
}

bool MovesBothWays(const SimulatedRun& run, int axis) {
  if (!run.response || run.heading.cols() == 0) return false;
  return run.heading.row(axis).maxCoeff() > 0.0 && run.heading.row(axis).minCoeff() < 0.0;
}

// One column for each motion, for a reversal of 1.
MatrixXd ColumnsOf(const SimulatedRun& run, const simulation::Response& response, int axis) {
  std::vector<simulation::Disturbance> halves;
  for (int motion = 0; motion < machine::kMotions; ++motion) {
    simulation::Disturbance& half = halves.emplace_back(run.heading.cols());
    half.row(simulation::MotionStage(axis, motion)) = 0.5 * run.heading.row(axis);
  }
  return response.Columns(halves);
}

bool IsIn(const estimation::Result& fit, const std::string& block) {
  return std::ranges::any_of(fit.blocks, [&](const auto& each) { return each.name == block; });
}

// What the runs say of the six reversals of an axis, all else marginalised, in units of the errors
// of the machine file: information and score.
struct Told {
  MatrixXd information;
  VectorXd score;

  // The logarithm of their evidence against none, for draws of one deviation.
  double Evidence(double deviation) const {
    const MatrixXd known =
        information + MatrixXd::Identity(score.size(), score.size()) / (deviation * deviation);
    const Eigen::LLT<MatrixXd> factor(known);
    const double gain = score.dot(factor.solve(score));
    const double volume = 2.0 * factor.matrixLLT().diagonal().array().log().sum() +
                          2.0 * static_cast<double>(score.size()) * std::log(deviation);
    return 0.5 * (gain - volume);
  }
};

Told ToldBy(const estimation::Result& fit, int axis, const VectorXd& deviations) {
  const auto names = BlocksOf(axis);
  MatrixXd covariance(machine::kMotions, machine::kMotions);
  VectorXd value(machine::kMotions), precision(machine::kMotions);
  for (int i = 0; i < 2; ++i) {
    const ParameterBlock& block = fit.Block(names[static_cast<std::size_t>(i)]);
    value.segment(i * kShifts, kShifts) = block.Values();
    for (Index e = 0; e < block.size(); ++e) {
      precision[i * kShifts + e] = std::pow(
          deviations[i * kShifts + e] / block.entries[static_cast<std::size_t>(e)].prior_sd, 2);
    }
    for (int j = 0; j < 2; ++j) {
      covariance.block(i * kShifts, j * kShifts, kShifts, kShifts) =
          fit.Covariance(names[static_cast<std::size_t>(i)], names[static_cast<std::size_t>(j)]);
    }
  }
  const VectorXd scale = deviations.cwiseInverse();
  const MatrixXd scaled = scale.asDiagonal() * covariance * scale.asDiagonal();
  const MatrixXd one = MatrixXd::Identity(machine::kMotions, machine::kMotions);
  const MatrixXd known = scaled.ldlt().solve(one);
  Told told{known, known * scale.cwiseProduct(value)};
  told.information.diagonal() -= precision;
  return told;
}

// Over the errors of the machine file; 0: none.
double SizeOf(const Told& told) {
  double size = 0.0, best = kLeastOdds;
  for (int power = kSmallest; power <= kLargest; ++power) {
    const double deviation = std::exp2(power), evidence = told.Evidence(deviation);
    if (!(evidence > best)) continue;
    best = evidence;
    size = deviation;
  }
  return size;
}

Judged Set(const VectorXd& deviations, ParameterBlock& block) {
  Judged judged = Judged::kAsBefore;
  for (Index i = 0; i < block.size(); ++i) {
    auto& entry = block.entries[static_cast<std::size_t>(i)];
    if (deviations[i] > 0.0) {
      if (entry.prior_sd != deviations[i]) judged = Judged::kOtherSize;
      entry.prior_sd = deviations[i];
    } else {
      if (!entry.held) judged = Judged::kNone;
      entry.held = true;
      entry.value = 0.0;
    }
  }
  return judged;
}

}  // namespace

bool IsReversal(const ParameterBlock& block) { return block.name.starts_with("reversal"); }

void WithReversals(const machine::Machine& machine, SimulatedRun& run) {
  std::shared_ptr<const simulation::Response> response;
  MatrixXd columns;
  std::vector<ParameterBlock> blocks;
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    if (!MovesBothWays(run, axis)) continue;
    if (!response) response = run.response->At(NominalValues(run.blocks));
    const MatrixXd own = ColumnsOf(run, *response, axis);
    columns.conservativeResize(own.rows(), columns.cols() + own.cols());
    columns.rightCols(own.cols()) = own;
    const VectorXd deviations = kAtFirst * DeviationsOf(machine, axis);
    const auto names = BlocksOf(axis);
    for (int i = 0; i < 2; ++i) {
      ParameterBlock block(names[static_cast<std::size_t>(i)],
                           i == 0 ? estimation::kMicrometres : estimation::kMicroradians, {});
      for (int e = 0; e < kShifts; ++e) {
        block.entries.push_back({.name = machine::MotionName(axis, i * kShifts + e),
                                 .prior_sd = deviations[i * kShifts + e]});
      }
      blocks.push_back(std::move(block));
    }
  }
  if (blocks.empty()) return;
  const auto with = [columns](std::shared_ptr<const estimation::Residual> base) {
    return std::make_shared<const estimation::ExtendedResidual>(
        std::move(base), VectorXd::Zero(columns.rows()), columns);
  };
  run.residual = with(run.residual);
  if (run.condense) {
    run.condense = [with, more = columns.cols(), base = run.condense](const VectorXd& x) {
      return with(base(x.head(x.size() - more)));
    };
  }
  for (ParameterBlock& block : blocks) run.blocks.push_back(std::move(block));
}

Judged JudgeReversals(const machine::Machine& machine, const estimation::Result& fit,
                      std::vector<SimulatedRun>& runs) {
  Judged judged = Judged::kAsBefore;
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    const auto names = BlocksOf(axis);
    if (!IsIn(fit, names[0]) || fit.Block(names[0]).entries[0].held) continue;
    const VectorXd deviations = DeviationsOf(machine, axis);
    const VectorXd found = SizeOf(ToldBy(fit, axis, deviations)) * deviations;
    for (SimulatedRun& run : runs) {
      for (ParameterBlock& block : run.blocks) {
        for (std::size_t i = 0; i < names.size(); ++i) {
          if (block.name != names[i]) continue;
          judged =
              std::max(judged, Set(found.segment(static_cast<Index>(i) * kShifts, kShifts), block));
        }
      }
    }
  }
  return judged;
}

std::vector<Reversal> ReversalsOf(const estimation::Result& fit, double widened) {
  std::vector<Reversal> reversals;
  for (const ParameterBlock& block : fit.blocks) {
    if (!IsReversal(block)) continue;
    for (const auto& entry : block.entries) {
      const double u = widened * entry.uncertainty;
      if (entry.held || !(std::abs(entry.value) > kBeyondChance * u)) continue;
      reversals.push_back({entry.name, entry.value, u, block.name.starts_with("reversal_turn")});
    }
  }
  return reversals;
}

}  // namespace abbe::fusion
