#include "fusion/run_suspect.h"

#include <algorithm>
#include <array>

#include "fusion/reversals.h"

namespace abbe::fusion {
namespace {

using estimation::ParameterBlock;
using simulation::SimulatedRun;

constexpr std::array kMounted{"target_tilt", "head_turn", "head_place", "base"};

bool HasBlock(const std::vector<ParameterBlock>& blocks, const ParameterBlock& block) {
  return std::any_of(blocks.begin(), blocks.end(),
                     [&](const ParameterBlock& each) { return each.name == block.name; });
}

Suspect BelongsTo(const ParameterBlock& block) {
  const bool mounting = std::any_of(kMounted.begin(), kMounted.end(),
                                    [&](const char* what) { return block.name.starts_with(what); });
  return mounting ? Suspect::kMounting : Suspect::kInstrument;
}

}  // namespace

std::optional<std::vector<ParameterBlock>> BlocksOfItsOwn(const std::vector<SimulatedRun>& runs,
                                                          std::size_t run, Suspect suspect,
                                                          const machine::VolumetricModel& model) {
  const std::vector<ParameterBlock> of_machine = model.Blocks();
  std::vector<ParameterBlock> blocks = runs[run].blocks;
  bool any = false;
  for (ParameterBlock& block : blocks) {
    if (IsReversal(block) || HasBlock(of_machine, block) || BelongsTo(block) != suspect) continue;
    const bool shared = std::any_of(runs.begin(), runs.end(), [&](const SimulatedRun& other) {
      return &other != &runs[run] && HasBlock(other.blocks, block);
    });
    if (!shared) continue;
    block.name += " of " + runs[run].name;
    any = true;
  }
  if (!any) return {};
  return blocks;
}

}  // namespace abbe::fusion
