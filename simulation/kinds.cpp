#include "simulation/kinds.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "failure/failure.h"

namespace abbe::simulation {
namespace {

std::vector<const RunKind*>& Kinds() {
#define ABBE_LIST_KIND(name) &name(),
  static std::vector<const RunKind*> kinds{ABBE_RUN_KINDS(ABBE_LIST_KIND)};
#undef ABBE_LIST_KIND
  return kinds;
}

std::string Listed(std::vector<std::string> names) {
  const std::string last = names.back();
  names.pop_back();
  return names.empty() ? last : fmt::format("{} and {}", fmt::join(names, ", "), last);
}

}  // namespace

const std::vector<const RunKind*>& RunKinds() { return Kinds(); }

void AddRunKind(const RunKind& kind) { Kinds().push_back(&kind); }

const RunKind& KindOf(const recording::Recording& head) {
  for (const RunKind* kind : Kinds()) {
    if (kind->Takes(head)) return *kind;
  }
  throw InputError(
      fmt::format("{}: kind is \"{}\"; known are {}", head.name, head.Kind(), KindNames()));
}

std::string KindNames(bool (RunKind::*wanted)() const) {
  std::vector<std::string> names;
  for (const RunKind* kind : Kinds()) {
    if ((kind->*wanted)()) names.emplace_back(kind->name());
  }
  return Listed(names);
}

std::string KindNames() {
  std::vector<std::string> names;
  for (const RunKind* kind : Kinds()) names.emplace_back(kind->name());
  return Listed(names);
}

std::vector<SimulatedRun> SimulateForMap(const RunSource& source,
                                         const machine::VolumetricModel& model,
                                         const Instruments& instruments) {
  const RunKind& kind = KindOf(source.head);
  if (kind.MakesMaps()) return kind.ForMap(source, model, instruments);
  throw InputError(fmt::format("{}: kind is \"{}\"; an error map is made of {}", source.head.name,
                               kind.name(), KindNames(&RunKind::MakesMaps)));
}

Correction Correct(const recording::Recording& recording, const std::vector<ModelledCause>& causes,
                   const Origin& origin, const Instruments& instruments) {
  if (causes.empty()) return {recording, {}};
  return KindOf(recording).Correct(recording, causes, origin, instruments);
}

recording::Recording Planned(recording::Recording path, const Instruments& instruments) {
  const RunKind& kind = KindOf(path);
  return kind.Plan(std::move(path), instruments);
}

void RefuseStrangers(const std::vector<RunSource>& sources, const Instruments& instruments) {
  for (const RunKind* kind : Kinds()) {
    std::vector<RunSource> of_kind;
    std::ranges::copy_if(sources, std::back_inserter(of_kind),
                         [&](const RunSource& source) { return &KindOf(source.head) == kind; });
    if (of_kind.size() > 1) kind->RefuseStrangers(of_kind, instruments);
  }
}

}  // namespace abbe::simulation
