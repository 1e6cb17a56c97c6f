// What was learned of a diagnosis, as data (docs/learned.md) and as text.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "learned/learning.h"

namespace abbe::apps {

// Entries "learned" and "left_before_learning" of the result; nothing where no term was learned.
void AddLearned(const learned::Learning& learning, nlohmann::ordered_json& result);
// Empty where no term was learned.
std::string LearnedText(const learned::Learning& learning);

}  // namespace abbe::apps
