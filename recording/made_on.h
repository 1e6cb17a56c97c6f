// On which machine a recording was made, and of which kind it is.
#pragma once

#include <string>
#include <string_view>

#include "recording/recording.h"

namespace abbe::recording {

// InputError when the header names a machine other than `machine`; it need not name one.
void RefuseOtherMachine(const Recording& recording, const std::string& machine);

// InputError when the recording is of another kind; `why` ends the message.
void RefuseOtherKind(const Recording& recording, std::string_view kind, std::string_view why);

}  // namespace abbe::recording
