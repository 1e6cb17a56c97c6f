// The check that a recording was made on a given machine.
#pragma once

#include <string>

#include "recording/recording.h"

namespace abbe::recording {

// InputError when the header names a machine other than `machine`; it need not name one.
void RefuseOtherMachine(const Recording& recording, const std::string& machine);

}  // namespace abbe::recording
