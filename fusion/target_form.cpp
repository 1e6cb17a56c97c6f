#include "fusion/target_form.h"

#include <utility>

namespace abbe::fusion {
namespace {

constexpr const char* kFormBlock = "target_form ";

}  // namespace

bool IsForm(const estimation::ParameterBlock& block) { return block.name.starts_with(kFormBlock); }

void WithForm(simulation::SimulatedRun& run) {
  if (!run.form_apart) return;
  simulation::FormApart apart = run.form_apart();
  run.form_apart = nullptr;
  run.residual = std::move(apart.residual);
  run.response = std::move(apart.response);
  for (auto& block : apart.blocks) run.blocks.push_back(std::move(block));
}

void SetForm(double k, simulation::SimulatedRun& run) {
  for (auto& block : run.blocks) {
    if (!IsForm(block)) continue;
    for (auto& entry : block.entries) entry.prior_sd = k * run.form_stated;
  }
}

}  // namespace abbe::fusion
