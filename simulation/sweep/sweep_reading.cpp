#include "simulation/sweep/sweep_reading.h"

namespace abbe::simulation {
namespace {

using Eigen::Vector3d;

// How far the carriages of these axes stand from where they are at zero.
Vector3d TravelOf(const machine::Chain& chain, const std::string& axes, const Vector3d& position) {
  Vector3d travel = Vector3d::Zero();
  for (const char axis : axes) {
    travel[axis - 'X'] += chain.CarriageSense(axis) * position[axis - 'X'];
  }
  return travel;
}

}  // namespace

SweepPlan MakeSweepPlan(const machine::Chain& chain, const Vector3d& reference,
                        const probes::HeadSettings& head, const SweepRun& run) {
  const probes::AxisFrame& frame = head.Frame(run.axis);
  Eigen::Matrix3d R_MH = frame.R_MH;
  if (run.mounted.head_turned) R_MH.leftCols<2>() *= -1.0;
  SweepPlan plan{chain,
                 machine::AxisIndex(run.axis),
                 R_MH,
                 frame.p_MH - TravelOf(chain, chain.tool_axes(), run.start) - reference,
                 frame.p_MH - TravelOf(chain, chain.workpiece_axes(), run.start) - reference,
                 head.electrode,
                 {}};
  for (std::size_t i = 0; i < kProbes; ++i) plan.height[i] = head.probes[i].range / 2;
  return plan;
}

Eigen::Vector2d PlaceOf(const probes::HeadLayout<>& layout, std::size_t probe) {
  if (OnTop(probe)) return {layout.top[probe].u, layout.top[probe].s};
  return {layout.side[probe - kTopProbes].u, layout.side[probe - kTopProbes].n};
}

}  // namespace abbe::simulation
