// The search for causes, with errors of the axes of other sizes and correlation lengths than the
// machine file states as a hypothesis of its own.
//
//   const Answer answer = BesidePopulation(campaign);
//
// A machine that is rougher than its file leaves something in every run; up to six causes that are
// not there had been named for it, each by itself more probable than errors of the stated kind.
// Where other sizes and lengths, one of each error function, may raise the likelihood by
// kWorthASearch, they are estimated from the simulation without causes
// (fusion/population_evidence.h); knots follow. Where they are more probable than the first cause
// or structure, the search goes by them; else it goes by the file, and once more by them where
// beside its causes they are more probable than the stated ones by kWorthASearch. A search by them
// is repeated once with the sizes and lengths that its causes leave; and once for each axis whose
// positioning error is rougher than the others, with it as these are: the wave of a screw had been
// taken for such an error, and an answer that leaves nothing unexplained may stand against it. The
// answer with the larger worth stands, sizes and lengths counted with their prior probability and
// their own uncertainty (Laplace). Causes widen squarenesses and slopes of the positioning errors,
// so the runs are not asked for their sizes; these follow the others as far as sizes of one machine
// go together.
// Units: SI. Failure: that of Fit.
// Source: docs/theory-diagnosis.md.
#pragma once

#include "diagnosis/answer.h"

namespace abbe::diagnosis {

Answer BesidePopulation(std::shared_ptr<const Campaign> campaign);

}  // namespace abbe::diagnosis
