// `abbe reduce` of a recording of kind "reference": ISO 230-2 figures of one axis.
//
// Rows are grouped by target (the commanded position, equal to 1 nm), direction and pass; the rows
// of one group are averaged. A deviation is reference - target. Flagged rows are left out and
// counted.
//
// Result:
//
//   {"kind": "reference", "axis": ...,
//    "iso230_2": {A_um, R_um, E_um, each also with _up and _down (A_up_um), M_um, B_um,
//                 mean_reversal_um, cycles, left_out_rows, "targets": [...]}}
//
// A target has target_mm, mean_up_um, mean_down_um, mean_um, reversal_um, std_up_um, std_down_um,
// R_up_um, R_down_um, R_um. "up" is direction +1. The mean reversal is signed: mean of (up - down).
// Failure:
// InputError for a recording of another kind, without a reference column, with a row that has no
// direction, or that standards/positioning.h refuses (fewer than two cycles, unequal cycles).
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "recording/recording.h"

namespace abbe::apps {

nlohmann::ordered_json ReduceReference(const recording::Recording& recording);

// The table for people, from the result of ReduceReference; ends in a newline.
std::string ReferenceTable(const nlohmann::ordered_json& result);

}  // namespace abbe::apps
