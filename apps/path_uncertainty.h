// How well the figures of a path test are known for what the calibration of the linkage leaves
// open.
//
//   AddCalibrationUncertainty(shifted, test);    // test.data["u_calibration"]["largest_um"]
//
// `shifted` holds the same test with each independent error of the calibration; the squares of what
// they change in a figure add up. Every number of the result whose key ends in _um or _urad gets
// its standard uncertainty, under the same keys below "u_calibration", and the table a line with
// U95 of those at the top. Curves are left out.
#pragma once

#include <vector>

#include "apps/path_result.h"

namespace abbe::apps {

void AddCalibrationUncertainty(const std::vector<TestResult>& shifted, TestResult& test);

}  // namespace abbe::apps
