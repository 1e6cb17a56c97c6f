// The calibration of an arm as data and as a table for people: lengths in mm, angles in degrees.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "fusion/arm_calibration.h"

namespace abbe::apps {

nlohmann::ordered_json ArmCalibrationJson(const fusion::ArmCalibration& found,
                                          const std::string& machine);
std::string ArmCalibrationTable(const fusion::ArmCalibration& found);

}  // namespace abbe::apps
