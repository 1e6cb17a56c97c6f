#include "certificate/doubts_of_result.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace abbe::certificate {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kFarOff = 3.0;  // residuals over their stated noise, as in `abbe fuse`

std::vector<std::string> TextsAt(const Json& result, const char* key) {
  std::vector<std::string> texts;
  const auto at = result.find(key);
  if (at == result.end() || !at->is_array()) return texts;
  for (const Json& each : *at) {
    if (each.is_string()) texts.push_back(each.get<std::string>());
  }
  return texts;
}

double NumberAt(const Json& result, const char* key, double otherwise) {
  const auto at = result.find(key);
  return at == result.end() || !at->is_number() ? otherwise : at->get<double>();
}

std::string TextAt(const Json& object, const char* key) {
  const auto at = object.find(key);
  return at == object.end() || !at->is_string() ? std::string() : at->get<std::string>();
}

}  // namespace

std::vector<std::string> DoubtsOfResult(const Json& result) {
  std::vector<std::string> doubts;
  if (!result.is_object()) return doubts;
  for (const std::string& run : TextsAt(result, "contradictions")) {
    doubts.push_back(
        fmt::format("Contradiction: {} disagrees with all other runs; every U95 is stated {:.2g} "
                    "times as large",
                    run, NumberAt(result, "widened", 1.0)));
  }
  for (const std::string& run : TextsAt(result, "misfits")) {
    doubts.push_back(fmt::format("Does not fit: the residuals of {} are beyond its noise", run));
  }
  const auto scatter = result.find("scatter");
  if (scatter != result.end() && scatter->is_array()) {
    for (const Json& each : *scatter) {
      doubts.push_back(fmt::format(
          "Scatter: the places of {} scatter along {} as no smooth map can hold; U95 contains it",
          TextAt(each, "run"), TextAt(each, "axis")));
    }
  }
  if (const double excess = NumberAt(result, "residuals_over_noise", 0.0); excess > kFarOff) {
    doubts.push_back(
        fmt::format("Does not fit: the residuals are {:.2g} times the stated noise", excess));
  }
  const auto left = result.find("unexplained");
  if (left != result.end() && left->is_array()) {
    for (const Json& each : *left) {
      if (!each.is_object()) continue;
      doubts.push_back(fmt::format("Unexplained: {} of {}, {:.3g} {}", TextAt(each, "variable"),
                                   TextAt(each, "object"), NumberAt(each, "amplitude", 0.0),
                                   TextAt(each, "unit")));
    }
  }
  const std::string verdict = TextAt(result, "verdict");
  if (verdict == "unexplained" || verdict == "ambiguous") {
    doubts.push_back(fmt::format("The diagnosis of the machine is {}", verdict));
  }
  const auto causes = result.find("causes_taken_out");
  if (causes != result.end() && causes->is_object() && causes->contains("doubt")) {
    doubts.emplace_back(
        "The causes that were taken out of the recordings stand beside something unexplained");
  }
  return doubts;
}

}  // namespace abbe::certificate
