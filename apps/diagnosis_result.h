// `abbe diagnose`: what it found, as data (docs/diagnose.md) and in words.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "diagnosis/diagnose.h"
#include "diagnosis/hold_out.h"

namespace abbe::apps {

nlohmann::ordered_json DiagnosisJson(const diagnosis::Diagnosis& diagnosis,
                                     const diagnosis::HeldOutGain& gain);
std::string DiagnosisText(const diagnosis::Diagnosis& diagnosis,
                          const diagnosis::HeldOutGain& gain);

}  // namespace abbe::apps
