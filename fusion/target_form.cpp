#include "fusion/target_form.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <utility>

#include "estimation/extended_residual.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;

constexpr const char* kFormBlock = "target_form ";

}  // namespace

bool IsForm(const estimation::ParameterBlock& block) { return block.name.starts_with(kFormBlock); }

void WithForm(simulation::SimulatedRun& run) {
  if (!run.form) return;
  const Eigen::MatrixXd columns = run.form();
  estimation::ParameterBlock block(kFormBlock + run.name, {"", 1.0}, {});
  for (Index i = 0; i < columns.cols(); ++i) block.entries.push_back({fmt::format("f{}", i)});
  run.residual = std::make_shared<estimation::ExtendedResidual>(
      run.residual, Eigen::VectorXd::Zero(columns.rows()), columns);
  run.blocks.push_back(std::move(block));
  SetForm(kHardlyMoreForm, run);
}

void SetForm(double k, simulation::SimulatedRun& run) {
  for (auto& block : run.blocks) {
    if (!IsForm(block)) continue;
    for (auto& entry : block.entries) entry.prior_sd = std::sqrt(k * k - 1.0);
  }
}

}  // namespace abbe::fusion
