// Recordings of a hole plate on the rig: the axis positions with a probe in the centre of each
// hole.
//
//   const recording::Recording plate = RecordPlate(world, {});       // the five set-ups
//
// The plate is a square grid of holes. Its certificate is correct but for the form of each hole and
// a common scale, which belong to the seed: all runs of a world measure one plate. Each set-up
// places it anew, with small errors of position and angle, and measures with its own stylus. The
// centre of a hole has white noise in the plate's two directions; the depth of the probe in it is
// known to 10 um only. All axes come to each hole from below, with `both_sides` to those of every
// second line from above (approach_x ...). Columns and header: docs/recordings.md.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "recording/recording.h"
#include "rig/world.h"

namespace abbe::rig {

struct PlateSetup {
  std::array<int, 2> directions;  // axis of M along plate_x and plate_y: 0, 1, 2
  Eigen::Vector3d tool;           // m: place of the probe in M with all axes at zero
};

// The plate once in XY, twice in XZ and twice in YZ, each of these with the stylus to either side.
std::vector<PlateSetup> FiveSetups(double stylus = 0.05);

struct PlateProgram {
  std::vector<PlateSetup> setups = FiveSetups();
  int holes = 7;              // along either side; the side is 0.9 of the shortest travel
  double u_form = 0.5e-6;     // m: of the place of one hole in each direction
  double u_scale = 1e-6;      // relative
  double u_probing = 0.2e-6;  // m
  std::uint64_t run = 1;
  bool both_sides = false;
};

recording::Recording RecordPlate(const World& world, const PlateProgram& program);

}  // namespace abbe::rig
