// Recordings for a command with a machine file: checked to be of that machine, warnings printed.
#pragma once

#include <filesystem>
#include <vector>

#include "machine/machine.h"
#include "recording/blocks.h"
#include "recording/recording.h"
#include "simulation/run_source.h"

namespace abbe::apps {

// InputError where one file is given twice, or a copy of it: its rows would count twice.
void RefuseTwice(const std::vector<std::filesystem::path>& recordings);
// The same where one is another with small changes (fusion/near_copy.h).
void RefuseNearCopies(const std::vector<std::filesystem::path>& recordings);

// Reads any recording and prints its warnings on standard error. Failure: that of
// recording/recording_file.h.
recording::Recording ReadWithWarnings(const std::filesystem::path& path);

// The same; also InputError when the recording names another machine.
recording::Recording ReadRecordingOf(const machine::Machine& machine,
                                     const std::filesystem::path& path);

// The recording without rows, and its blocks, which can be read repeatedly;
// warnings are printed with the first reading.
recording::Recording ReadHeadOf(const machine::Machine& machine, const std::filesystem::path& path);
recording::Blocks BlocksOf(const std::filesystem::path& path);
// Head, blocks and whole recording, each read when asked for.
simulation::RunSource SourceAt(const machine::Machine& machine, const std::filesystem::path& path);

}  // namespace abbe::apps
