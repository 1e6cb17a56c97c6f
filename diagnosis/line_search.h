// The waves that a cause could be: over time (a vibration), an axis (a screw), a pivot (an encoder).
//
//   const Line line = StrongestLine(fit, {&cause, "Y", shape});
//   line.score.log_evidence - std::log(line.among);
//
// Over an hour a frequency is known to some 1e-4 Hz: a hundred thousand of them are resolved
// between 1 and 60 Hz, too many to score. First pieces of the runs are looked through by
// themselves, in which few are resolved; about those that stand out, aliases of each other too, all
// runs together are looked through, means of stays with what their averages keep, as long as the
// wave keeps its phase; the best of these are scored. Waves over an axis or a pivot likewise, in
// pieces that mostly are as long as the motion.
// Units: shapes as in simulation::Wave (Hz, m, order). Source: periodogram of unequal times, Lomb,
// Astrophys. Space Sci. 39 (1976).
#pragma once

#include <vector>

#include "diagnosis/fit.h"

namespace abbe::diagnosis {

struct Line {
  Score score;
  double among = 1.0;  // waves that the runs tell apart
  double step = 1.0;   // from the shape to the nearest other one, a factor
};

// The candidate with the shapes that stand out, at most so many; of a cause with a `wave`.
std::vector<Candidate> LinesThatStandOut(const Fit& fit, const Candidate& candidate,
                                         std::size_t at_most);

// In waves per unit: what a single piece of the runs tells apart; 0 without a wave.
double ResolvedBy(const Fit& fit, const Candidate& candidate);

// The shape of `candidate` is tried beside them.
Line StrongestLine(const Fit& fit, const Candidate& candidate);

}  // namespace abbe::diagnosis
