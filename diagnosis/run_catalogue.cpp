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

// Prepares what the kinds propose; those out of reach are left out.
class Catalogue {
 public:
  Catalogue(const Campaign& campaign, const std::vector<Recording>& recordings,
            const simulation::PathAbout& about)
      : campaign_(campaign), about_(about) {
    for (const Recording& each : recordings) {
      recorded_[&simulation::KindOf(each)].push_back(&each);
    }
  }

  void AddFirst(const simulation::RunKind& kind) {
    Add(kind.FirstRuns(campaign_.instruments(), about_));
  }
  void AddNext(const simulation::RunKind& kind) {
    Add(kind.NextRuns(recorded_[&kind], campaign_.instruments(), about_));
  }
  std::vector<PossibleRun> Take() { return std::move(possible_); }

 private:
  void Add(std::vector<simulation::NextRun> runs) {
    const simulation::Instruments& instruments = campaign_.instruments();
    for (simulation::NextRun& next : runs) {
      Recording path;
      try {
        path = simulation::Planned(std::move(next.path),
                                   next.instruments ? *next.instruments : instruments);
      } catch (const NumericalError&) {
        continue;  // out of reach
      }
      const double seconds =
          simulation::DurationOf(path) + simulation::StartedOf(path) - about_.started;
      path.name = fmt::format("planned {}", possible_.size() + 1);  // unknowns of its own
      Campaign alone = campaign_.WithoutRuns();
      alone.Add(path);
      PreparedRun run = alone.runs().front();
      if (next.start) next.start(run.simulated);
      possible_.push_back({std::move(next.text), seconds, std::move(run), std::move(path)});
    }
  }

  const Campaign& campaign_;
  const simulation::PathAbout& about_;
  std::map<const simulation::RunKind*, std::vector<const Recording*>> recorded_;
  std::vector<PossibleRun> possible_;
};

}  // namespace

std::vector<PossibleRun> PossibleRuns(const Campaign& campaign,
                                      const std::vector<Recording>& recordings) {
  const simulation::PathAbout about = AboutNext(campaign, recordings);
  Catalogue catalogue(campaign, recordings, about);
  for (const simulation::RunKind* kind : simulation::RunKinds()) catalogue.AddNext(*kind);
  return catalogue.Take();
}

std::vector<PossibleRun> PossibleRuns(const Campaign& campaign,
                                      const std::vector<Recording>& recordings,
                                      const simulation::PathAbout& about,
                                      const WantedKind& wanted) {
  Catalogue catalogue(campaign, recordings, about);
  for (const simulation::RunKind* kind : simulation::RunKinds()) {
    if (!wanted(*kind)) continue;
    catalogue.AddFirst(*kind);
    catalogue.AddNext(*kind);
  }
  return catalogue.Take();
}

}  // namespace abbe::diagnosis
