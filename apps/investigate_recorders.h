// Who records the runs of an investigation: the virtual rig by itself, or an operator.
#pragma once

#include <memory>

#include "apps/machine_file.h"
#include "apps/rig_option.h"
#include "investigate/investigation.h"

namespace abbe::apps {

// Instants that an effect does not state are drawn in the first hour.
std::unique_ptr<investigate::Recorder> RigRecorder(const MachineFile& file,
                                                   const RigOption& option);

// Writes a program for the control, prompts, and reads the path of the recording from standard
// input; at its end the run waits for the next call.
std::unique_ptr<investigate::Recorder> OperatorRecorder();

}  // namespace abbe::apps
