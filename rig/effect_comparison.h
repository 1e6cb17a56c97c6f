// Compares the findings of a diagnosis with the hidden effects of the rig.
//
// Truth: the JSON that --truth wrote, with "hidden" as in hidden_effect.h. Diagnosis: the JSON of
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
  double probability = 0.0;  // as reported; 0: not reported
  std::vector<KeyComparison> keys;
};

struct FindingsComparison {
  std::vector<EffectComparison> hidden;
  std::vector<std::string> wrong;  // reported but not hidden
};

FindingsComparison CompareFindings(const nlohmann::ordered_json& truth,
                                   const nlohmann::ordered_json& diagnosis,
                                   const std::string& name);

}  // namespace abbe::rig
