// `abbe diagnose`: what it found, as data (docs/diagnose.md) and in words.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "diagnosis/diagnose.h"
#include "diagnosis/hold_out.h"

namespace abbe::apps {

// "thermal-growth:X (temp_table_c)".
std::string NameOf(const diagnosis::Candidate& candidate);
// The unit that the name of a key ends in: "width_um" -> "um", "..._nm_per_mm2" -> "nm/mm2".
std::string UnitOf(const std::string& key);

nlohmann::ordered_json DiagnosisJson(const diagnosis::Diagnosis& diagnosis,
                                     const diagnosis::HeldOutGain& gain);
std::string DiagnosisText(const diagnosis::Diagnosis& diagnosis,
                          const diagnosis::HeldOutGain& gain);

}  // namespace abbe::apps
