#include "simulation/run_kind.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <set>

#include "simulation/planned_run.h"

namespace abbe::simulation {

using recording::Recording;

RunSource SourceOf(Recording recording) {
  const auto shared = std::make_shared<const Recording>(std::move(recording));
  Recording head;
  head.name = shared->name;
  head.header = shared->header;
  for (const auto& column : shared->columns) head.columns.push_back({column.name, {}});
  return {std::move(head), [shared](const auto& use) { use(*shared); },
          [shared] { return *shared; }};
}

std::vector<SimulatedRun> RunKind::ForMap(const RunSource& source, const machine::VolumetricModel&,
                                          const Instruments&) const {
  throw InputError(fmt::format("{}: no error map is made of a {}", source.head.name, name()));
}

void RunKind::RefuseStrangers(const std::vector<RunSource>&, const Instruments&) const {}

Correction RunKind::Correct(const Recording& recording, const std::vector<ModelledCause>&,
                            const Origin&, const Instruments&) const {
  return {recording, {}};
}

RowRule RunKind::HeldOut(const Recording&) const { return {}; }

Recording RunKind::Part(const Recording& recording, const RowRule& wanted) const {
  Recording part = recording;
  for (auto& column : part.columns) column.values.clear();
  for (std::size_t row = 0; row < recording.rows(); ++row) {
    if (!wanted(row)) continue;
    for (std::size_t c = 0; c < part.columns.size(); ++c) {
      part.columns[c].values.push_back(recording.columns[c].values[row]);
    }
  }
  return part;
}

std::optional<std::string> RunKind::HeldOutGroup(const Recording&) const { return {}; }

Recording RunKind::Plan(Recording path, const Instruments&) const {
  FlagPlaces(path);
  return path;
}

std::string RunKind::MountingOf(const Recording&) const { return {}; }

std::vector<NextRun> RunKind::FirstRuns(const Instruments&, const PathAbout&) const { return {}; }

std::vector<NextRun> RunKind::NextRuns(const std::vector<const Recording*>&, const Instruments&,
                                       const PathAbout&) const {
  return {};
}

RowRule EverySecondPass(const Recording& recording) {
  const auto pass = recording.Find("pass");
  if (!pass || std::set<double>(pass->begin(), pass->end()).size() < 2) return {};
  return [pass](std::size_t row) { return std::lround((*pass)[row]) % 2 == 0; };
}

RowRule EverySecondBlock(const Recording& recording) {
  constexpr std::size_t kBlocks = 8;
  const std::size_t block = recording.rows() / kBlocks + 1;
  return [block](std::size_t row) { return (row / block) % 2 == 1; };
}

RowRule EverySecondPassOrBlock(const Recording& recording) {
  RowRule passes = EverySecondPass(recording);
  return passes ? passes : EverySecondBlock(recording);
}

void NoteUnknownTimes(const Recording& recording, std::vector<std::string>& notes) {
  if (recording.KnowsTimes()) return;
  notes.push_back(
      fmt::format("{}: knows the order of its readings, not their times; one reading counts as one "
                  "second, so results in s count readings",
                  recording.name));
}

}  // namespace abbe::simulation
