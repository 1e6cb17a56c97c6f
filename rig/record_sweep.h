// Recordings of the rig without wires: what `abbe sweep` would write of a sweep of this world, made
// in memory in milliseconds, for statistics over many seeds.
//
//   const World world(ReadRigSettings(document.Root()), seed);
//   const auto devices = hal::ReadDevices(document.Root().Child("devices"));
//   const recording::Recording sweep = RecordSweep(world, 'X', ChannelsOf(devices),
//                                                 {.rate = 75.0});
//
// Columns and header are those of hal/sweep_recorder.h, with every pass from its first motion. The
// values are those of the sensors before they are cut into counts. A gap outside 0 to `range` is
// NaN with the flag kOutOfRange. The same (machine file, seed, axis, run, rate) gives the same
// recording.
//
// What the world hides acts here too: the machine is followed row by row, motion included
// (hidden_run.h), and x_mm, y_mm, z_mm stay what the controller shows.
//
// Speed: while the axis moves by less than 1 nm the gaps are kept; they change by less than 1e-12 m
// there (slopes of the faces and of the errors are below 1e-3).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/device_settings.h"
#include "hal/sample_source.h"
#include "recording/recording.h"
#include "rig/climate.h"
#include "rig/world.h"

namespace abbe::rig {

struct CampaignOptions {
  double rate = 200.0;        // rows in a second; at most the sensors' update rate
  bool moving = true;         // also write the rows between the stations
  std::uint64_t run = 1;      // runs of one world differ in their noise only; 0 is the served rig's
  std::string mounting = {};  // for the header; empty: not stated
  std::string started = "1970-01-01T00:00:00Z";  // for the header
  std::string more = {};       // further lines of its table [mounting], or of TOML
  int passes = 0;              // 0: as many as the machine file plans
  double begin = 0.0;          // s since the machine was switched on
  Climate* climate = nullptr;  // of a campaign; none: its own, and `begin` is 0
};

// The channels that the devices of a machine file give, in their order.
std::vector<hal::Channel> ChannelsOf(const hal::DevicesSettings& devices);

// `axis` 'X', 'Y' or 'Z'. InputError when no sweep of the axis is programmed, when the rate is
// above the update rate, or when a channel is none of the rig's.
recording::Recording RecordSweep(const World& world, char axis,
                                 const std::vector<hal::Channel>& channels,
                                 const CampaignOptions& options = {});

}  // namespace abbe::rig
