// A recording as a simulation takes it: whole, or block by block where it may be of any length.
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

RunSource SourceOf(recording::Recording recording);

}  // namespace abbe::simulation
