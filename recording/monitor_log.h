// Import of the log of a channel monitor (EPICS camonitor) into a recording of kind "dwell", or,
// with the angles of the sensors round a turning shaft (degrees), of kind "shaft".
//
//   TARGET_DU:Rotation-PosAct 2023-02-08 14:21:15.970781 94.2006
//   channel                   date       time            value [alarm ...]
//
// Each channel is logged only when it changes. A row is one instant; the columns of channels
// without a value at that instant are nan. The log has no units: the user names the columns, and
// the ending of a name is the unit. Other channels are ignored, as are the words after the value
// (alarms). Rows are sorted by time; time_s is local time from the first row on.
//
// Failure: InputError with file and line for a line without an instant, or a value of a
// requested channel that is not a number; InputError with the file for a requested channel
// without any value (the message lists those with values), and for no requested channel.
// "***" (not connected) is not a value.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "recording/recording.h"

namespace abbe::recording {

struct MonitoredColumn {
  std::string name;     // "gap_1_mm"
  std::string channel;  // "TARGET:m0s002-AI01"
};

// Whether the first line has the form above.
bool IsMonitorLog(const std::filesystem::path& path);

Recording ReadMonitorLog(const std::filesystem::path& path,
                         const std::vector<MonitoredColumn>& columns,
                         const std::vector<double>& sensor_degrees = {});

}  // namespace abbe::recording
