// `abbe path`: what the path tests found, as data and as a table.
//
// The keys of the data are listed in docs/circle.md. A result holds the figures of one test, for
// each recording and instrument.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "relm/cap_displacement.h"
#include "relm/measured_path.h"
#include "relm/path_deviation.h"
#include "relm/square_path.h"
#include "relm/stepping_test.h"
#include "standards/articulation.h"

namespace abbe::apps {

struct TestResult {
  nlohmann::ordered_json data;
  std::string table;  // ends in a newline
};

TestResult SteppingResult(const std::vector<relm::SteppingLine>& lines);
TestResult SquareResult(const relm::SquareFigures& figures);
// Of the same path as it was measured, and aligned with the commanded one.
TestResult DeviationResult(const relm::PathDeviation& raw, const relm::PathDeviation& aligned);
TestResult CapResult(const std::vector<relm::CapDisplacement>& displacements);
TestResult ArticulationResult(const standards::Articulation& figures);

}  // namespace abbe::apps
