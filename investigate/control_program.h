// The program of a planned path for the control of a machine: G-code of LinuxCNC.
//
//   WriteText(ControlProgram(path, "record a circle in XY ..."), "03.ngc");
//
// Rows at one place are a stand (G4) as long as they last, at least half a second; rows on the way
// are straight moves at the feed of the path (G1). Motions of different pass or direction are apart
// by a stand; a closed one runs in and out by a quarter of itself.
// Frames: positions that the control shows.
// Units: mm, mm/min, s, as G21 G90 G94 say.
// Failure: InputError for a path without positions or feed.
// Source: LinuxCNC, G-code reference (RS274/NGC): G1, G4, G17, G21, G64, G90, G94, M2.
// Validity: a path without tool, spindle and coolant; the way to its first place is at the feed,
// straight. Whether it is free of collisions the reader has to see.
#pragma once

#include <string>

#include "recording/recording.h"

namespace abbe::investigate {

// `title`: one line, for a comment.
std::string ControlProgram(const recording::Recording& path, const std::string& title);

}  // namespace abbe::investigate
