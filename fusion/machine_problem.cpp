#include "fusion/machine_problem.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <string>

#include "failure/failure.h"
#include "simulation/linkage/linkage_simulation.h"

namespace abbe::fusion {
namespace {

using estimation::BlockId;
using estimation::ParameterBlock;

void AddMachine(const MachinePrior& prior, const machine::VolumetricModel& model,
                estimation::Problem& problem, std::map<std::string, BlockId>& known) {
  for (ParameterBlock& block : model.Blocks()) {
    if (block.name == "squareness") {
      for (auto& entry : block.entries) entry.prior_sd = prior.population().squareness;
    }
    const std::string name = block.name;
    known.emplace(name, problem.Add(std::move(block)));
  }
}

void AddSmoothness(const MachinePrior& prior, const machine::VolumetricModel& model,
                   estimation::Problem& problem) {
  const auto source = problem.AddSource(std::string(kSmoothnessSource), {.is_prior = true});
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      if (model.Function(axis, motion).size() == 0) continue;
      const Eigen::MatrixXd W = prior.Whitening(axis, motion);
      problem.Add(source,
                  std::make_shared<estimation::LinearResidual>(W, Eigen::VectorXd::Zero(W.rows())),
                  {problem.Find(machine::MotionName(axis, motion))}, 1.0);
    }
  }
}

}  // namespace

estimation::Problem MakeMachineProblem(const machine::Machine& /*machine*/,
                                       const machine::VolumetricModel& model,
                                       const MachinePrior& prior,
                                       const std::vector<simulation::SimulatedRun>& runs,
                                       const std::vector<double>& noise) {
  if (runs.empty()) throw InputError("no recording to fuse; name at least one");
  estimation::Problem problem;
  std::map<std::string, BlockId> known;
  AddMachine(prior, model, problem, known);
  for (std::size_t r = 0; r < runs.size(); ++r) {
    std::vector<estimation::Input> inputs;
    for (const ParameterBlock& block : runs[r].blocks) {
      auto at = known.find(block.name);
      if (at == known.end()) at = known.emplace(block.name, problem.Add(block)).first;
      if (problem.Block(at->second).size() != block.size()) {
        throw InputError(
            fmt::format("{}: was simulated with another machine model: {} has {} "
                        "coefficients here, {} there",
                        runs[r].name, block.name, block.size(), problem.Block(at->second).size()));
      }
      inputs.emplace_back(at->second);
    }
    const auto same = [&](const simulation::SimulatedRun& other) {
      return other.name == runs[r].name;
    };
    const bool unique = std::count_if(runs.begin(), runs.end(), same) == 1;
    const auto source =
        problem.AddSource(unique ? runs[r].name : fmt::format("{} ({})", runs[r].name, r + 1),
                          {.loss = runs[r].loss});
    problem.Add(source, runs[r].residual, inputs, noise.empty() ? 1.0 : noise[r]);
  }
  AddSmoothness(prior, model, problem);
  return problem;
}

Eigen::VectorXd NominalValues(const std::vector<estimation::ParameterBlock>& blocks) {
  Eigen::Index count = 0;
  for (const auto& block : blocks) count += block.size();
  Eigen::VectorXd values(count);
  for (Eigen::Index first = 0; const auto& block : blocks) {
    values.segment(first, block.size()) = block.Values();
    first += block.size();
  }
  return values;
}

std::vector<int> ColumnsOf(const std::vector<std::string>& names,
                           const std::vector<ParameterBlock>& blocks) {
  std::vector<int> columns;
  for (const auto& block : blocks) {
    for (std::size_t i = 0; i < block.entries.size(); ++i) {
      const auto at = std::find(names.begin(), names.end(), block.FullName(i));
      columns.push_back(static_cast<int>(at - names.begin()));
    }
  }
  return columns;
}

Eigen::VectorXd ValuesFound(const estimation::Result& fit,
                            const std::vector<ParameterBlock>& blocks) {
  std::vector<double> values;
  for (const ParameterBlock& block : blocks) {
    for (const auto& entry : fit.Block(block.name).entries) values.push_back(entry.value);
  }
  return Eigen::Map<Eigen::VectorXd>(values.data(), values.size());
}

bool OutlivesRuns(const ParameterBlock& block, const std::vector<simulation::SimulatedRun>& runs) {
  if (block.name == simulation::BaseBlock("") || block.name == simulation::BaseTurnBlock("")) {
    return false;
  }
  return std::none_of(runs.begin(), runs.end(), [&](const simulation::SimulatedRun& run) {
    return block.name.ends_with(" " + run.name);
  });
}

}  // namespace abbe::fusion
