#include "diagnosis/run_catalogue.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "failure/failure.h"
#include "simulation/kinds.h"

namespace abbe::diagnosis {
namespace {

using recording::Recording;

// When the next run could begin, and how warm it was last.
simulation::PathAbout AboutNext(const Campaign& campaign,
                                const std::vector<Recording>& recordings) {
  constexpr double kPause = 60.0;  // s
  simulation::PathAbout about{campaign.instruments().machine.name};
  for (const Recording& recording : recordings) {
    about.started = std::max(about.started,
                             simulation::StartedOf(recording) + simulation::DurationOf(recording));
    for (const auto& column : recording.columns) {
      if (column.name.starts_with("temp_") && !column.values.empty()) {
        about.temperature[column.name] = column.values.back();
      }
    }
  }
  about.started += kPause;
  return about;
}

}  // namespace

std::vector<PossibleRun> PossibleRuns(const Campaign& campaign,
                                      const std::vector<Recording>& recordings) {
  const simulation::Instruments& instruments = campaign.instruments();
  const simulation::PathAbout about = AboutNext(campaign, recordings);
  std::map<const simulation::RunKind*, std::vector<const Recording*>> recorded;
  for (const Recording& each : recordings) recorded[&simulation::KindOf(each)].push_back(&each);
  std::vector<PossibleRun> possible;
  for (const simulation::RunKind* kind : simulation::RunKinds()) {
    for (simulation::NextRun& next : kind->NextRuns(recorded[kind], instruments, about)) {
      Recording path;
      try {
        path = simulation::Planned(std::move(next.path),
                                   next.instruments ? *next.instruments : instruments);
      } catch (const NumericalError&) {
        continue;  // out of reach
      }
      const double seconds =
          simulation::DurationOf(path) + simulation::StartedOf(path) - about.started;
      path.name = fmt::format("planned {}", possible.size() + 1);  // unknowns of its own
      Campaign alone = campaign.WithoutRuns();
      alone.Add(std::move(path));
      PreparedRun run = alone.runs().front();
      if (next.start) next.start(run.simulated);
      possible.push_back({std::move(next.text), seconds, std::move(run)});
    }
  }
  return possible;
}

}  // namespace abbe::diagnosis
