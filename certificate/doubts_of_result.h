// Reasons for which nothing is certified as conforming: contradictions between runs, runs that do
// not fit, and what a diagnosis left without an explanation.
//
//   for (const std::string& doubt : DoubtsOfResult(result)) fmt::print("{}\n", doubt);
//
// Failure: none; a key that the result lacks is no doubt. Source: the keys of `abbe fuse`, `abbe
// plate`, `abbe calibrate` and `abbe diagnose` (docs/report.md). Validity: what a result does not
// say cannot be seen here.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace abbe::certificate {

// One sentence for each.
std::vector<std::string> DoubtsOfResult(const nlohmann::ordered_json& result);

}  // namespace abbe::certificate
