// What a recording that holds still (kind dwell) says of the linkage: its encoders, in blocks.
//
//   if (auto standing = StandingLinkage(recording, model, instruments)) {
//     prepared.runs.push_back(*std::move(standing));
//   }
//
// A run of the linkage at one place: the ball sits in its cap as it came there (ball_seat), and
// what the encoders show beyond noise is a lost count, a drift, a vibration. Its rows are means of
// as many readings as leave kStandingBlocks rows. Empty where the recording lacks axis positions or
// the angle of a joint, the machine file a linkage, or the axes do not stand.
// Failure: that of ReadLinkageRun. For use within simulation/ only.
#pragma once

#include <optional>

#include "simulation/run_kind.h"

namespace abbe::simulation {

inline constexpr Eigen::Index kStandingBlocks = 120;

std::optional<PreparedRun> StandingLinkage(const recording::Recording& recording,
                                           const machine::VolumetricModel& model,
                                           const Instruments& instruments);

// Writes the angles that close the nominal linkage at the positions of a path into it.
void PlanAngles(const Instruments& instruments, recording::Recording& path);

}  // namespace abbe::simulation
