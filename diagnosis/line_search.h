// The strongest line in time that a cause could be.
//
//   const Line line = StrongestLine(fit, {&cause, "Y", shape});
//   line.score.log_evidence - std::log(line.among);
//
// Over an hour a frequency is known to some 1e-4 Hz: a hundred thousand of them are resolved
// between 1 and 60 Hz, too many to score. First the runs whose rows are single readings and tell
// most are looked through by themselves, where their few seconds leave some hundred frequencies;
// about those that stand out, aliases of each other too, all these runs together are looked
// through, as long as the line keeps its phase; the best of them are scored. Rows that are means of
// stays only count in the score. Units: Hz.
#pragma once

#include "diagnosis/fit.h"

namespace abbe::diagnosis {

struct Line {
  Score score;
  double among = 1.0;  // frequencies that the runs tell apart
  double step = 0.0;   // Hz: nearest other one that was tried
};

// The shape of `candidate` is tried beside those found. Of a cause with `line_in`.
Line StrongestLine(const Fit& fit, const Candidate& candidate);

}  // namespace abbe::diagnosis
