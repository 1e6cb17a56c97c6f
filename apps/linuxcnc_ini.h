// A machine as LinuxCNC's INI file describes it.
//
//   ReadLinuxcncIni("mill.ini", machine);      // fills name and travels
//
// Read: [EMC] MACHINE, [TRAJ] LINEAR_UNITS and COORDINATES, [AXIS_X] MIN_LIMIT and MAX_LIMIT,
// [KINS] KINEMATICS. The travels and the soft limits become those of the control; which axis
// carries the workpiece does not stand there. Units: mm, from inches where the file has them.
// Failure: InputError with file and line or section, also where LINEAR_UNITS is missing or no unit.
// Source: LinuxCNC 2.9, INI configuration.
#pragma once

#include <filesystem>

#include "apps/machine_template.h"

namespace abbe::apps {

void ReadLinuxcncIni(const std::filesystem::path& path, MachineDescription& machine);

}  // namespace abbe::apps
