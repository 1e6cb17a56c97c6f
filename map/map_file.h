// The file of an error map: TOML, written by `abbe fuse`, read by the commands that use the map.
//
//   format = 1
//   machine = "demo-mill"
//   chain = "[w X Y b Z t]"
//   positive = "carriage carriage tool"         # sign of X, Y and Z, machine/chain.h
//   reference = [0.0, 0.0, 0.0]                 # m
//   tool = [0.0, 0.0, 0.0]                      # m, of the measurement
//   temperature_c = 20.0
//   scale = "calibrated"                        # or "prior only"
//   squareness = [1.2e-05, -3e-06, 8e-06]       # A0Z B0Z C0Y, rad
//   squareness_from = ["linkage", "linkage", "prior"]
//   [travel]
//   x = [0.0, 0.06]  y = ...  z = ...           # m
//   [limit]                                     # the soft limits, m; absent: unknown
//   x = [-0.0001, 0.0601]  y = ...  z = ...
//   [[error]]                                   # at most 18; an absent one is zero
//   name = "EXX"
//   from = "sweep"                              # a kind of run, or prior
//   form = "b-spline"                           # machine/form_of_shape.h
//   degree = [3.0]
//   knots_m = [...]
//   gauge = "none"                              # of an imported table; absent: "zero at start"
//   coefficients = [...]                        # m or rad
//   [covariance]                                # absent: a map without uncertainty
//   names = ["EXX.c0", ...]
//   rows = [...]                                # the lower triangle, row after row, SI
//   [state]                                     # of a map that is kept true (map_state.h), or absent
//   time = "2026-11-21T09:00:00Z"
//   walk = [...]                                # 8 sizes of [population] after a day, SI, or absent
//   names = ["response table EXX.linear", "probe_gain.a", ...]
//   values = [...]
//   rows = [...]                                # rows of the covariance below those of the map
//   [[state.sensor]]
//   name = "table"
//   lag_s = 1800.0
//   temperature_c = 21.5
//   lagged_c = 21.3
//
// All numbers are SI and in the shortest form that reads back the same, so a map is the same bit
// for bit after writing and reading.
// Frames: as error_map.h.
// Units: SI but where a key ends in another unit. Shapes: the covariance P x P as its lower
// triangle, P names.
// Failure: InputError with file, line and key, also for a number that is not finite; for a
// truncated file with its last line.
// Source: own format, version 1.
// Validity: a reader refuses another `format`.
#pragma once

#include <filesystem>

#include "map/error_map.h"

namespace abbe::map {

// Under a temporary name first, then renamed. Missing folders are made.
void WriteMap(const ErrorMap& map, const std::filesystem::path& path);
// The same map, bit for bit.
ErrorMap ReadMap(const std::filesystem::path& path);

}  // namespace abbe::map
