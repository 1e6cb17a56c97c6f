// What an extended model is not sure of, and what that does to a result corrected by it: the one
// place of the rule, for every command that takes a model.
//
//   RefuseUnexplained(model, "mill.causes.toml", although);     // InputError
//   const bool doubtful = !IsCertain(model, cause);   // its change counts as uncertainty
//   u = WithDoubt(u, with - without, UnexplainedInSpace(model));
//
// Where structure is left that no known cause explains, no cause of the model is certain: whatever
// makes that structure may have been taken for them. Applied all the same, the result
//   may as well be the one without the causes that are not certain: the change that they make
//     counts as one standard uncertainty,
//   may be off by what is left: its rms, as a displacement of the measured point, counts as one.
// Both are combined in quadrature with what is stated, so U95 exceeds the change: a result is never
// worse by such a cause than its U95 says. A cause that is not certain among its rivals is applied
// likewise, without what is left.
// Units: m, rad. Shapes: single numbers.
// Failure: InputError as each function says.
// Source: JCGM 100:2008, 5.1.2 (combination in quadrature); own choice of the parts.
// Validity: what is left is taken as large elsewhere as in the runs of the diagnosis.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "simulation/extended_model.h"

namespace abbe::simulation {

inline constexpr double kCertain = 0.99;  // probability of a cause that is taken as there

// By the verdict of the diagnosis.
bool IsUnexplained(const ExtendedModel& model);
// Probable enough, and nothing unexplained beside it.
bool IsCertain(const ExtendedModel& model, const ModelledCause& cause);

// What is left, m rms, of all together; 0: nothing. InputError where a part of it has no size in
// space, so that no U95 can be stated.
double UnexplainedInSpace(const ExtendedModel& model);

// InputError for a model beside which something is unexplained, unless `although` that is wanted;
// it names `file`, the largest leftover and what to do.
void RefuseUnexplained(const ExtendedModel& model, const std::filesystem::path& file,
                       bool although);

// A standard uncertainty with the change by doubtful causes and with what is unexplained.
double WithDoubt(double u, double change, double unexplained);

// "not certain: backlash:X (probability 0.510; or cap-friction:cap)"; empty: all of `causes` are.
std::string DoubtText(const ExtendedModel& model, const std::vector<ModelledCause>& causes);
// "probe_a over time, 0.21 um, and 2 more"; empty: nothing is left.
std::string UnexplainedText(const ExtendedModel& model);

}  // namespace abbe::simulation
