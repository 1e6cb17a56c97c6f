// What an axis sweep shall do: the stations of one axis and how often, how long and how fast they
// are visited. The table [sweep] of the machine file; the recorder follows it, the virtual rig
// performs it.
//
// One pass goes forward (towards +) through all stations and back through all of them. Every
// station is approached from both sides, also the end ones: the axis turns `overrun` beyond them.
//
//   pass 1: turn at first - overrun; +: s0 s1 ... sn; turn at last + overrun; -: sn ... s1 s0; pass
//   2: ...
//
// At each turn the axis stands still for `settle`, at each station for `settle` + `dwell` at least.
//
// The first motion is from anywhere to first - overrun; it belongs to no pass (pass 0).
// Units: m, s, m/s.
// Failure: InputError with file, line and key.
// Source: docs/sweep.md; both approaches as in ISO 230-2.
#pragma once

#include <vector>

#include "settings/document.h"

namespace abbe::hal {

struct Visit {
  std::size_t station;  // index into SweepPlan::stations
  int direction;        // +1 or -1, of the approach
  int pass;             // from 1
};

struct SweepPlan {
  char axis = 'X';               // 'X', 'Y' or 'Z'
  std::vector<double> stations;  // m, increasing, at least two
  int passes = 5;
  double dwell = 0.5;     // s of good readings wanted at a station, after settling
  double settle = 0.1;    // s from arrival to the first reading that counts
  double window = 2e-5;   // m; nearer than this to a station is standing on it
  double feed = 0.01;     // m/s, commanded between stations
  double idle = 60.0;     // s without motion after which the sweep is over
  double overrun = 5e-4;  // m beyond the end stations, at least four windows

  // All visits in their order: 2 * passes * stations.
  std::vector<Visit> Visits() const;
  double first() const { return stations.front(); }
  double last() const { return stations.back(); }
};

// Reads the plan of one axis from the table [sweep]: common keys passes (5), dwell_s (0.5),
// settle_s (0.1), window_um (20), feed_mm_min (600), overrun_mm (0.5), and in [sweep.X] either
// stations_mm or first_mm, last_mm and step_mm. InputError with file, line and key for an unknown
// key, stations that do not increase or lie nearer than four windows, a step that does not divide
// the length, or an overrun of less than four windows.
SweepPlan ReadSweepPlan(const settings::Table& sweep, char axis);

}  // namespace abbe::hal
