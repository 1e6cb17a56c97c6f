#include "simulation/sweep_run.h"

#include <algorithm>
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
  const std::vector<int>& directions = means.directions;
  for (Eigen::Index row = 0; row < run.rows(); ++row) {
    const auto group = static_cast<std::size_t>(row);
    const int direction = directions[group % directions.size()];
    const std::size_t station = group / directions.size();
    const auto first =
        std::find_if(means.dwells.begin(), means.dwells.end(), [&](const probes::Dwell& dwell) {
          return dwell.station == station && dwell.direction == direction;
        });
    run.direction.push_back(direction);
    run.first_rows.push_back(first->first_row);
  }
  return run;
}

}  // namespace abbe::simulation
