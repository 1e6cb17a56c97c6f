#include "simulation/sweep_run.h"

#include <utility>

#include "probes/sweep_dwells.h"
#include "probes/sweep_stations.h"

namespace abbe::simulation {

SweepRun ReadSweepRun(const recording::Recording& recording, const probes::HeadSettings& head,
                      const probes::ProbeNoise& noise) {
  const auto dwells = probes::FindDwells(recording, probes::DwellRuleOf(recording), head.Ranges());
  auto means = probes::FitStations(recording.name, dwells, noise);
  SweepRun run;
  run.name = recording.name;
  run.mounting = recording.HeaderText("mounting").value_or("");
  run.axis = dwells.axis;
  run.start = dwells.start;
  run.position = std::move(means.position);
  run.gap = std::move(means.gap);
  run.covariance = std::move(means.covariance);
  for (Eigen::Index row = 0; row < run.rows(); ++row) {
    run.direction.push_back(
        means.directions[static_cast<std::size_t>(row) % means.directions.size()]);
  }
  return run;
}

}  // namespace abbe::simulation
