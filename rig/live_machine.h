// The rig's machine as it runs: at rest, or performing the sweep of an axis since it was started.
//
// The sensors take a new reading `update_rate` times a second; between two updates they show the
// same values. The axis that was started last has the head installed for its sweep (X before the
// first). Time is simulated time since the rig was switched on, s, and must not go back by more
// than a sweep. Not safe for several threads: register_server.h locks.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rig/motion.h"
#include "rig/noise.h"
#include "rig/world.h"

namespace abbe::rig {

enum class ProgramState : std::uint16_t { kIdle = 0, kRunning = 1, kDone = 2 };

class LiveMachine {
 public:
  explicit LiveMachine(const World& world);

  // Starts the programmed sweep of axis 0, 1, 2. False when one is running or none is programmed.
  bool Start(int axis, double time);

  ProgramState StateAt(double time) const;
  int axis() const { return axis_; }  // started last

  // What a channel (rig_channel.h) reads, in the unit of its name, at the latest update. Empty: the
  // gap is out of the probe's range, 0 to `range`, or the rig has no such channel.
  std::optional<double> ReadingOf(std::string_view channel, double time);

 private:
  struct Snapshot {
    std::uint64_t tick = 0;
    double time = 0.0;
    Eigen::Vector3d position;
    Readings gaps{};
  };

  Snapshot Take(std::uint64_t tick);

  const World& world_;
  SensorNoise noise_;
  int axis_ = 0;
  double started_ = 0.0;
  std::optional<SweepMotion> motion_;
  std::optional<Snapshot> latest_;
  std::vector<std::string> temperatures_;  // in the order of their first reading
};

}  // namespace abbe::rig
