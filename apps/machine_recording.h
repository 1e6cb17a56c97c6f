// A recording for a command that has read a machine file: made on that machine, its warnings shown.
#pragma once

#include <filesystem>

#include "machine/machine.h"
#include "recording/blocks.h"
#include "recording/recording.h"

namespace abbe::apps {

// Any recording, its warnings on standard error. Failure: that of recording/recording_file.h.
recording::Recording ReadWithWarnings(const std::filesystem::path& path);

// The same; InputError when the recording names another machine, and those of
// recording/recording_file.h.
recording::Recording ReadRecordingOf(const machine::Machine& machine,
                                     const std::filesystem::path& path);

// The same without its rows, and its blocks, as often as wanted; warnings come with the first time.
recording::Recording ReadHeadOf(const machine::Machine& machine, const std::filesystem::path& path);
recording::Blocks BlocksOf(const std::filesystem::path& path);

}  // namespace abbe::apps
