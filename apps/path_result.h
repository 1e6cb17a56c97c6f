// The result of `abbe path` as data and as a table: the figures of one test, for each recording and
// instrument. docs/circle.md lists the keys of the data.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "paths/cap_displacement.h"
#include "paths/measured_path.h"
#include "paths/path_deviation.h"
#include "paths/square_path.h"
#include "paths/stepping.h"
#include "standards/articulation.h"

namespace abbe::apps {

struct TestResult {
  nlohmann::ordered_json data;
  std::string table;  // ends in a newline
};

TestResult SteppingResult(const std::vector<paths::SteppingLine>& lines);
TestResult SquareResult(const paths::SquareFigures& figures);
// The same path as measured, and aligned with the commanded one.
TestResult DeviationResult(const paths::PathDeviation& raw, const paths::PathDeviation& aligned);
TestResult CapResult(const std::vector<paths::CapDisplacement>& displacements);
TestResult ArticulationResult(const standards::Articulation& figures);

}  // namespace abbe::apps
