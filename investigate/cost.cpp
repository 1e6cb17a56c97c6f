#include "investigate/cost.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "failure/failure.h"
#include "settings/unit.h"
#include "simulation/kinds.h"

namespace abbe::investigate {
namespace {

std::set<std::string> KnownInstruments() {
  std::set<std::string> known;
  for (const simulation::RunKind* kind : simulation::RunKinds()) {
    known.emplace(kind->Instrument());
  }
  return known;
}

// Estimates; an instrument without an entry has the last one.
InstrumentCost DefaultOf(const std::string& instrument) {
  static const std::map<std::string, InstrumentCost> defaults{
      {"head", {15.0 * kMinute, 5.0 * kMinute}}, {"linkage", {10.0 * kMinute, 5.0 * kMinute}}};
  const auto found = defaults.find(instrument);
  return found != defaults.end() ? found->second : InstrumentCost{20.0 * kMinute, 10.0 * kMinute};
}

std::vector<std::string> DescribedBy(const simulation::Instruments& instruments) {
  std::vector<std::string> described;
  if (instruments.head) described.emplace_back("head");
  if (instruments.linkage) described.emplace_back("linkage");
  return described;
}

Costs Read(const settings::Table& root, const std::vector<std::string>& described) {
  const settings::Table table = root.Child("investigate");
  Costs costs;
  costs.run = kMinute * table.Number("run_min", {.fallback = 1.0, .at_least = 0.0});
  const std::set<std::string> known = KnownInstruments();
  std::map<std::string, InstrumentCost> stated;
  for (const std::string& name : known) {
    const settings::Table own = table.Child(name);
    const InstrumentCost usual = DefaultOf(name);
    const auto minutes = [&](const char* key, double fallback) {
      return kMinute * own.Number(key, {.fallback = fallback / kMinute, .at_least = 0.0});
    };
    stated[name] = {minutes("set_up_min", usual.set_up), minutes("again_min", usual.again)};
  }
  for (const std::string& name : table.Texts("at_hand", 0, described)) {
    if (!known.contains(name)) {
      throw table.Error("at_hand", fmt::format("\"{}\" is no instrument; those that runs are made "
                                               "with are {}",
                                               name, fmt::join(known, ", ")));
    }
    costs.at_hand.emplace(name, stated.at(name));
  }
  return costs;
}

}  // namespace

Costs ReadCosts(const settings::Table& root, const simulation::Instruments& instruments) {
  return Read(root, DescribedBy(instruments));
}

void CheckCosts(const settings::Table& root) { Read(root, {}); }

Place PlaceOf(const recording::Recording& run) {
  const simulation::RunKind& kind = simulation::KindOf(run);
  return {std::string(kind.Instrument()), kind.MountingOf(run)};
}

Minutes CostOf(const recording::Recording& path, const Place& before, double waiting,
               const Costs& costs) {
  const Place place = PlaceOf(path);
  const auto own = costs.at_hand.find(place.instrument);
  const InstrumentCost cost =
      own != costs.at_hand.end() ? own->second : DefaultOf(place.instrument);
  Minutes minutes{.waiting = waiting / kMinute,
                  .run = (costs.run + simulation::DurationOf(path)) / kMinute};
  if (place.instrument != before.instrument) {
    minutes.set_up = cost.set_up / kMinute;
  } else if (place != before) {
    minutes.set_up = cost.again / kMinute;
  }
  return minutes;
}

Minutes CostOfCampaign(const std::vector<recording::Recording>& recordings, const Costs& costs) {
  constexpr double kWait = 600.0;  // s: a longer pause is one for warming up
  Minutes sum;
  Place before;
  double ended = 0.0;
  for (const recording::Recording& recording : recordings) {
    const double started = simulation::StartedOf(recording);
    const double pause = ended > 0.0 ? started - ended : 0.0;
    const Minutes own = CostOf(recording, before, pause > kWait ? pause : 0.0, costs);
    sum.set_up += own.set_up;
    sum.waiting += own.waiting;
    sum.run += own.run;
    before = PlaceOf(recording);
    ended = started + simulation::DurationOf(recording);
  }
  return sum;
}

}  // namespace abbe::investigate
