// The uncertainty of the figures of a path test from the calibration of the linkage.
//
//   AddCalibrationUncertainty(shifted, left, test);    // test.data["u_calibration"]["largest_um"]
//
// `shifted` holds the same test with each independent error of the calibration; their changes of a
// figure add up in squares. Every number of the result whose key ends in _um or _urad gets its
// standard uncertainty, under the same keys below "u_calibration", and the table gets a line with
// the largest U95 of each key. Curves are left out. `left`: what is unexplained beside an extended
// model (simulation/doubt.h), which is added in squares.
#pragma once

#include <vector>

#include "apps/path_result.h"

namespace abbe::apps {

struct LeftUnexplained {
  double displacement = 0.0;  // m
  double angle = 0.0;         // rad: that over the extent of the path
};

void AddCalibrationUncertainty(const std::vector<TestResult>& shifted, const LeftUnexplained& left,
                               TestResult& test);

}  // namespace abbe::apps
