// What a run costs on the machine: minutes to set its instrument up, to wait, and to run.
//
//   const Costs costs = ReadCosts(document.Root(), instruments);
//   const Minutes minutes = CostOf(path, now, 0.0, costs);
//
// An instrument that is not on the machine takes `set_up`, one that is there but mounted otherwise
// `again`: another axis of the head, a target or a base mounted anew, the other elbow. Both as the
// kind of the run says (simulation/run_kind.h).
// Units: s inside, minutes in the file. Shapes: one entry an instrument.
// Failure: InputError with file, line and key for an unknown instrument.
// Source: own; the defaults are estimates for a small mill, docs/machine-file.md.
// Validity: what was taken off is taken to return to its place, as on dowels.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "recording/recording.h"
#include "settings/document.h"
#include "simulation/instruments.h"

namespace abbe::investigate {

inline constexpr double kMinute = 60.0;  // s

struct InstrumentCost {
  double set_up = 0.0, again = 0.0;  // s
};

struct Costs {
  std::map<std::string, InstrumentCost> at_hand;  // by the name of the instrument
  double run = 60.0;                              // s, to begin a run and to look at it
};

// The table [investigate]. Without a list of what is at hand: the head and the linkage where the
// machine file describes them.
Costs ReadCosts(const settings::Table& root, const simulation::Instruments& instruments);
// Requests all its keys, for commands that need none of them.
void CheckCosts(const settings::Table& root);

// What is on the machine, and how.
struct Place {
  std::string instrument, mounting;

  friend bool operator==(const Place&, const Place&) = default;
};
// By the header.
Place PlaceOf(const recording::Recording& run);

struct Minutes {
  double set_up = 0.0, waiting = 0.0, run = 0.0;

  double total() const { return set_up + waiting + run; }
};
// `waiting`: s. `before`: what is on the machine; without a name nothing is.
Minutes CostOf(const recording::Recording& path, const Place& before, double waiting,
               const Costs& costs);

// The cost of recordings that were made one after the other.
Minutes CostOfCampaign(const std::vector<recording::Recording>& recordings, const Costs& costs);

}  // namespace abbe::investigate
