// abbe calibrate of an arm before an instrument (fusion/arm_calibration.h).
#pragma once

#include <filesystem>
#include <vector>

#include "apps/causes_option.h"

namespace abbe::apps {

struct ArmArguments {
  std::vector<std::filesystem::path> recordings, checks;
  std::filesystem::path machine, out, json;  // out: the new machine file
  CausesOption causes;
  bool quiet = false;
};

// The exit code. Failure: InputError for a recording that is of no arm or stands among the tests
// too, an output that is the machine file; that of fusion/arm_calibration.h.
int CalibrateArm(const ArmArguments& arguments);

}  // namespace abbe::apps
