// Names that the writer and the reader of a DCC share. For use within certificate/.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "certificate/xml.h"

namespace abbe::certificate {

inline std::vector<XmlNamespace> DccNamespaces() {
  return {{"dcc", "https://ptb.de/dcc"},
          {"si", "https://ptb.de/si"},
          {"xsi", "http://www.w3.org/2001/XMLSchema-instance"}};
}

// Units in SI, as abbe writes them, and in the notation of D-SI.
inline constexpr std::array<std::pair<const char*, const char*>, 10> kDsiUnits{
    {{"m", R"(\metre)"},
     {"rad", R"(\radian)"},
     {"1/K", R"(\kelvin\tothe{-1})"},
     {"um", R"(\micro\metre)"},
     {"urad", R"(\micro\radian)"},
     {"mm", R"(\milli\metre)"},
     {"ppm", R"(\ppm)"},
     {"degC", R"(\degreecelsius)"},
     {"", R"(\one)"},
     {"%", R"(\percent)"}}};

inline constexpr const char* kRemark = "abbe_remark";
inline constexpr const char* kDoubt = "abbe_doubt";
inline constexpr const char* kDecisionRule = "abbe_decisionRule";
inline constexpr const char* kConformity = "abbe_conformity";
inline constexpr const char* kSeries = "abbe_series";
inline constexpr const char* kPositions = "abbe_positions";
inline constexpr const char* kValues = "abbe_values";
inline constexpr const char* kJoint = "abbe_jointValues";
inline constexpr const char* kTemperature = "abbe_machineTemperature";
inline constexpr const char* kCondition = "abbe_condition";

inline constexpr const char* kNoRule = "No decision rule was agreed; no conformity is stated.";
inline constexpr const char* kRule =
    "Guard band of U95 on both sides of the limit: pass if |value| + U95 <= limit, fail if |value| "
    "- U95 > limit, conditional between the two. Formula as published about the standard.";

}  // namespace abbe::certificate
