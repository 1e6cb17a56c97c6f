// An investigation: the run that tells most a minute is chosen, recorded and diagnosed, then the
// next, until the verdict is certain, a further run leaves the same unexplained, no run promises
// more, or the budget is spent.
//
//   const Ended ended = Investigate(subject, recorder, journal);
//   ended.why;                             // Why::kCertain
//
// A verdict is certain when
//   explained  each finding has a probability of 99 % and rows that were held out agree,
//   clean      nothing is 99 % probable among all that the runs at hand could show.
// Units: minutes, s since 1970. Shapes: one step a run.
// Failure: that of the diagnosis and of the recorder; the journal holds all steps before.
// Source: own; expected information: choice.h.
// Validity: one thing the matter, more only where each is certain by itself.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/diagnose.h"
#include "diagnosis/hold_out.h"
#include "investigate/cost.h"
#include "investigate/journal.h"

namespace abbe::investigate {

struct Subject {
  simulation::Instruments instruments;
  Costs costs = {};
  std::vector<std::string> sensors = {};  // columns of temperatures, "temp_table_c"
  double room = 20.0;                     // degC, before they are known
  double budget = 45.0;                   // minutes
  double least_bits = 0.01;               // a run that promises less is not made
};

// Who records. Nothing of what it knows beyond the recordings reaches the investigation.
class Recorder {
 public:
  virtual ~Recorder() = default;
  // Whether it can make the run at all.
  virtual bool Records(const recording::Recording& path) const = 0;
  // The file name in the folder of the journal; nothing: not yet.
  virtual std::optional<std::string> Record(const recording::Recording& path,
                                            const Journal& journal) = 0;
  // When the run begins, s since 1970, if its set-up ends at `planned`.
  virtual double Begin(double planned) const { return planned; }
};

enum class Why { kCertain, kLeftAgain, kNothingMore, kBudget, kWaiting };
// "the verdict is certain".
std::string Text(Why why);

struct Ended {
  Why why;
  std::vector<recording::Recording> recordings;
  std::optional<diagnosis::Diagnosis> diagnosis = {};  // none before the first run
  diagnosis::HeldOutGain gain = {};
};

// `show`: one line for a person after each change of the journal.
Ended Investigate(const Subject& subject, Recorder& recorder, Journal& journal,
                  const std::function<void(const std::string& line)>& show = {});

}  // namespace abbe::investigate
