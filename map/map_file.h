// The file of an error map: TOML, written by `abbe fuse`, read by whatever puts the map to use.
//
//   format = 1
//   machine = "demo-mill"
//   chain = "[w X Y b Z t]"
//   positive = "carriage carriage tool"         # how X, Y and Z count, machine/chain.h
//   reference = [0.0, 0.0, 0.0]                 # m
//   tool = [0.0, 0.0, 0.0]                      # m, of the measurement
//   temperature_c = 20.0
//   scale = "calibrated"                        # or "prior only"
//   squareness = [1.2e-05, -3e-06, 8e-06]       # A0Z B0Z C0Y, rad
//   squareness_from = ["linkage", "linkage", "prior"]
//   [travel]
//   x = [0.0, 0.06]  y = ...  z = ...           # m
//   [limit]                                     # the soft limits, m; left out: not known
//   x = [-0.0001, 0.0601]  y = ...  z = ...
//   [[error]]                                   # 18 of them, those that are zero may be left out
//   name = "EXX"
//   from = "sweep"                              # sweep, linkage, reference, plate, length, prior
//   form = "b-spline"                           # machine/form_of_shape.h
//   degree = [3.0]
//   knots_m = [...]
//   gauge = "none"                              # of an imported table; left out: "zero at start"
//   coefficients = [...]                        # m or rad
//   [covariance]                                # left out: the map states no uncertainty
//   names = ["EXX.c0", ...]
//   rows = [...]                                # the lower triangle, row after row, SI
//
// All numbers are SI and in the shortest form that reads back the same, so a map that is written
// and read is the same bit for bit.
// Failure: InputError with file, line and key, for a number that is not finite too; for a file
// that breaks off, its last line.
#pragma once

#include <filesystem>

#include "map/error_map.h"

namespace abbe::map {

// Under a temporary name first, then renamed. Missing folders are made.
void WriteMap(const ErrorMap& map, const std::filesystem::path& path);
ErrorMap ReadMap(const std::filesystem::path& path);

}  // namespace abbe::map
