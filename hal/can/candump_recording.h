// Logs of candump as recordings, and recordings as logs that canplayer sends again.
// Units: rad, s. Shapes: one row a SYNC or round of PDOs.
// Failure: InputError as each function says.
// Source: hal/can/canopen_source.h judges the frames.
// Validity: a log whose stamps are those of one clock.
#pragma once

#include "hal/can/candump_log.h"
#include "hal/can/canopen_settings.h"
#include "recording/recording.h"

namespace abbe::hal {

// What abbe would have recorded as a listener on that bus: one row for each SYNC (or, where there
// are none, for each round of PDOs), with the angles of the encoders and `flags`. time_s counts
// from the first frame of the log. A log has no axes, so the kind is "dwell". `stale_s` as in
// DevicesSettings. InputError when the log has no frames of the interface or no row would be good.
recording::Recording RecordingOf(const CandumpLog& log, const CanopenSettings& device,
                                 double stale_s, const std::string& machine);

// The SYNC and the PDOs that an encoder would have sent for each row, one microsecond apart; no PDO
// for an angle that is not finite. InputError when the recording has no column of an encoder.
CandumpLog LogOf(const recording::Recording& recording, const CanopenSettings& device);

}  // namespace abbe::hal
