// A recording as a simulation takes it: whole, or block by block where it may be of any length.
// Units: those of a recording. Shapes: blocks of rows in the order of the file.
// Failure: that of the reader of the recording.
// Validity: `whole` reads all rows at once.
#pragma once

#include <functional>

#include "recording/blocks.h"
#include "recording/recording.h"

namespace abbe::simulation {

struct RunSource {
  recording::Recording head;  // name, header and names of the columns; no rows are read of it
  recording::Blocks blocks;
  std::function<recording::Recording()> whole;
};

// A recording that is in memory.
RunSource SourceOf(recording::Recording recording);

}  // namespace abbe::simulation
