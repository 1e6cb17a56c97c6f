// Whether a diagnosis found what the rig hides.
//
// Truth: the JSON that --truth wrote, with "hidden" as hidden_effect.h says. Diagnosis: the JSON of
// `abbe diagnose`, with "findings": [{"cause", "object", "probability", "parameters": [{"name",
// "value", "u95"}]}]. Sizes are in the units of the keys, a phase within half a turn of the truth.
// Failure: InputError naming the file when a key is missing.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace abbe::rig {

struct KeyComparison {
  std::string name;
  double truth, found, u95;
};

struct EffectComparison {
  std::string name;          // "backlash:X"
  double probability = 0.0;  // as named; 0: not named
  std::vector<KeyComparison> keys;
};

struct FindingsComparison {
  std::vector<EffectComparison> hidden;
  std::vector<std::string> wrong;  // named without being there
};

FindingsComparison CompareFindings(const nlohmann::ordered_json& truth,
                                   const nlohmann::ordered_json& diagnosis,
                                   const std::string& name);

}  // namespace abbe::rig
