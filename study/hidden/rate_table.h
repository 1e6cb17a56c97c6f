// What many worlds with one hidden effect show together: rates, power against what can be seen, and
// which names stood in for which.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "study/hidden/judgement.h"
#include "study/study.h"

namespace abbe::study {

// Standard deviations beyond which an effect counts as seen.
inline constexpr double kSeen = 5.0;

// What of an effect can be seen at all (visible_effects.h), in standard deviations: of its column,
// of what its best rival leaves of it, and of the largest size that the rig hides.
struct Visible {
  double alone = 0.0, beside = 0.0, largest = 0.0;
};

// How the diagnosis met the one effect that a world hides.
Row JudgeOne(const rig::HiddenEffect& truth, const Visible& visible, const Diagnosis& diagnosis);

// Sums rows of JudgeOne; "at_floor" stands in those whose rest was held out.
Summary SumOfOne(const std::string& variant, const std::vector<Row>& rows);

}  // namespace abbe::study
