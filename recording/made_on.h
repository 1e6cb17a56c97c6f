// On which machine a recording was made.
#pragma once

#include <string>

#include "recording/recording.h"

namespace abbe::recording {

// InputError when the header names another machine than this one; a header may name none.
void RefuseOtherMachine(const Recording& recording, const std::string& machine);

}  // namespace abbe::recording
