// A recording of any length, read block by block in the memory of one block.
//
//   const Blocks blocks = [&](const UseBlock& use) { ReadBlocks("volume.h5", use); };
//   blocks([&](const Recording& block) { rows += block.rows(); });       // as often as wanted
//
// Each block is a recording with the name, the header and the columns of the whole and some of its
// rows, from `first_row` on. The last block has the warnings. A recording without rows is one block
// without rows.
#pragma once

#include <functional>

#include "recording/recording.h"

namespace abbe::recording {

using UseBlock = std::function<void(const Recording& block)>;
using Blocks = std::function<void(const UseBlock& use)>;

}  // namespace abbe::recording
