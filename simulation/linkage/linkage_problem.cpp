#include "simulation/linkage/linkage_problem.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <memory>
#include <utility>

#include "failure/failure.h"
#include "simulation/linkage/linkage_gaps.h"
#include "simulation/remembered_noise.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using estimation::BlockId;
using estimation::ParameterBlock;
using simulation::LinkageRun;
using simulation::LinkageSimulation;

bool IsBase(const ParameterBlock& block) { return block.name.starts_with("base"); }

// The blocks of the base of a mounting, then those of the model.
std::vector<const ParameterBlock*> BlocksOf(const std::vector<ParameterBlock>& blocks,
                                            const std::string& mounting) {
  std::vector<const ParameterBlock*> found;
  for (const std::string& name :
       {simulation::BaseBlock(mounting), simulation::BaseTurnBlock(mounting)}) {
    for (const ParameterBlock& block : blocks) {
      if (block.name == name) found.push_back(&block);
    }
  }
  if (found.size() != 2) {
    throw InputError(fmt::format("calibration: no base of a mounting \"{}\"", mounting));
  }
  for (const ParameterBlock& block : blocks) {
    if (!IsBase(block)) found.push_back(&block);
  }
  return found;
}

std::shared_ptr<const estimation::Residual> GapsOf(const LinkageSimulation& simulation,
                                                   const LinkageRun& run, const RunNoise& noise) {
  if (!noise.memory) return std::make_shared<LinkageGaps>(simulation, run);
  return WithMemory(std::make_shared<LinkageGaps>(LinkageGaps::Evenly(simulation, run)), run.time,
                    *noise.memory);
}

}  // namespace

std::vector<std::string> MountingsOf(const std::vector<LinkageRun>& runs) {
  std::vector<std::string> names;
  for (const LinkageRun& run : runs) {
    if (std::find(names.begin(), names.end(), run.mounting) == names.end()) {
      names.push_back(run.mounting);
    }
  }
  return names;
}

VectorXd ParametersOf(const std::vector<ParameterBlock>& blocks, const std::string& mounting) {
  std::vector<double> x;
  for (const ParameterBlock* block : BlocksOf(blocks, mounting)) {
    for (const auto& entry : block->entries) x.push_back(entry.value);
  }
  return Eigen::Map<VectorXd>(x.data(), x.size());
}

std::vector<int> ColumnsOf(const std::vector<ParameterBlock>& blocks, const std::string& mounting,
                           const std::vector<std::string>& names) {
  std::vector<int> columns;
  for (const ParameterBlock* block : BlocksOf(blocks, mounting)) {
    for (std::size_t i = 0; i < block->entries.size(); ++i) {
      const auto at = std::find(names.begin(), names.end(), block->FullName(i));
      columns.push_back(at == names.end() ? -1 : static_cast<int>(at - names.begin()));
    }
  }
  return columns;
}

estimation::Result SolveLinkage(const estimation::Problem& problem, int threads,
                                bool weak_directions, double settled, double tolerated) {
  constexpr int kFewPasses = 20;
  try {
    return problem.Solve({.max_iterations = kFewPasses,
                          .threads = threads,
                          .settled = settled,
                          .tolerated = tolerated,
                          .jacobian_bytes = 0,
                          .weak_directions = weak_directions});
  } catch (const NumericalError&) {
    return problem.Solve({.threads = threads,
                          .settled = settled,
                          .tolerated = tolerated,
                          .weak_directions = weak_directions});
  }
}

estimation::Problem MakeLinkageProblem(const LinkageSimulation& simulation,
                                       const std::vector<LinkageRun>& runs,
                                       const LinkageProblemOptions& options) {
  if (runs.empty()) throw InputError("calibration: no recording; name at least one");
  const std::vector<ParameterBlock> blocks = simulation.Blocks();
  const std::vector<std::string> mountings = MountingsOf(runs);
  estimation::Problem problem;
  std::vector<std::vector<estimation::Input>> inputs(mountings.size());
  for (std::size_t m = 0; m < mountings.size(); ++m) {
    ParameterBlock base = blocks[0], turn = blocks[1];
    base.name = simulation::BaseBlock(mountings[m]);
    turn.name = simulation::BaseTurnBlock(mountings[m]);
    if (options.displacement) {
      for (auto& entry : base.entries) entry.prior_sd = estimation::kNoPrior;
      base.Free();
    }
    inputs[m] = {problem.Add(base), problem.Add(turn)};
  }
  for (std::size_t b = 2; b < blocks.size(); ++b) {
    const BlockId id = problem.Add(blocks[b]);
    for (auto& list : inputs) list.emplace_back(id);
  }
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const LinkageRun& run = runs[r];
    if (run.poses() == 0) throw InputError(fmt::format("{}: has no poses", run.name));
    const auto same = [&](const LinkageRun& other) { return other.name == run.name; };
    const bool unique = std::count_if(runs.begin(), runs.end(), same) == 1;
    const auto source = problem.AddSource(
        unique ? run.name : fmt::format("{} ({})", run.name, r + 1), {.loss = options.loss});
    const std::size_t m =
        std::find(mountings.begin(), mountings.end(), run.mounting) - mountings.begin();
    const RunNoise noise = options.noise.empty() ? RunNoise{} : options.noise[r];
    problem.Add(source, GapsOf(simulation, run, noise), inputs[m],
                noise.memory ? 1.0 : noise.deviation);
  }
  return problem;
}

}  // namespace abbe::simulation
