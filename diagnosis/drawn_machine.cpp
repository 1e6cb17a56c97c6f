#include "diagnosis/drawn_machine.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <string>

#include "machine/error_motion.h"

namespace abbe::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Normal = std::function<double()>;

VectorXd Draws(Index count, const Normal& normal) {
  VectorXd draws(count);
  for (double& each : draws) each = normal();
  return draws;
}

void DrawFunctions(const Campaign& campaign, const Normal& normal, Values& values) {
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      if (campaign.model().Function(axis, motion).size() == 0) continue;
      const Eigen::MatrixXd W = campaign.prior().Whitening(axis, motion);
      values.emplace(machine::MotionName(axis, motion),
                     W.colPivHouseholderQr().solve(Draws(W.rows(), normal)));
    }
  }
}

VectorXd Drawn(const estimation::ParameterBlock& block, const Normal& normal) {
  VectorXd values = block.Values();
  if (block.name.starts_with("head_place")) return values;  // the gaps are set
  const double most = block.name.starts_with("target_tilt") ? kAligned : estimation::kNoPrior;
  for (std::size_t i = 0; i < block.entries.size(); ++i) {
    const auto& entry = block.entries[i];
    if (entry.held || !std::isfinite(entry.prior_sd)) continue;
    values[i] = entry.nominal + std::min(entry.prior_sd, most) * normal();
  }
  return values;
}

}  // namespace

Values DrawnMachine(const Campaign& campaign, const Normal& normal) {
  return DrawnMachine(campaign, campaign.runs(), normal);
}

Values DrawnMachine(const Campaign& campaign, const std::vector<PreparedRun>& runs,
                    const Normal& normal) {
  Values values;
  DrawFunctions(campaign, normal, values);
  values.emplace("squareness",
                 campaign.instruments().machine.population.squareness * Draws(3, normal));
  for (const PreparedRun& run : runs) {
    for (const auto& block : run.simulated.blocks) {
      if (!values.contains(block.name)) values.emplace(block.name, Drawn(block, normal));
    }
  }
  return values;
}

}  // namespace abbe::diagnosis
