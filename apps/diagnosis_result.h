// The result of `abbe diagnose` as data (docs/diagnose.md) and as text.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "diagnosis/diagnose.h"
#include "diagnosis/hold_out.h"
#include "simulation/extended_model.h"

namespace abbe::apps {

// "thermal-growth:X (temp_table_c)".
std::string NameOf(const diagnosis::Candidate& candidate);
// A key of a cause as name, quantity and unit: "time_constant_s", "time constant", "s".
nlohmann::ordered_json KeyJson(const std::string& name);

// Measured less simulated where it shows; not empty.
nlohmann::ordered_json CurveJson(const diagnosis::Curve& curve);
nlohmann::ordered_json LeftoverJson(const diagnosis::Leftover& leftover);

nlohmann::ordered_json DiagnosisJson(const diagnosis::Diagnosis& diagnosis,
                                     const diagnosis::HeldOutGain& gain);
// What is left unexplained alike is one line, with `verbose` a line each.
std::string DiagnosisText(const diagnosis::Diagnosis& diagnosis, const diagnosis::HeldOutGain& gain,
                          bool verbose = false);

// The file of a model, which states the recordings that it was found from and their hashes.
std::string ModelText(simulation::ExtendedModel model,
                      const std::vector<std::filesystem::path>& recordings);

}  // namespace abbe::apps
