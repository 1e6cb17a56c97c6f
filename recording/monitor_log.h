// Reads the log of a channel monitor (EPICS camonitor) into a recording of kind "dwell", or, with
// the places of the sensors round a turning shaft (degrees), of kind "shaft".
//
//   TARGET_DU:Rotation-PosAct 2023-02-08 14:21:15.970781 94.2006
//   channel                   date       time            value [alarm ...]
//
// Each channel speaks for itself and only when it changes, so a row is one moment: the columns that
// were silent then are nan. The log knows no units; who imports names the columns, and the end of a
// name is the unit. Channels that nobody asked for are left out; words after the value are alarms
// and are not kept. Rows are sorted by time, which is local time and counts from the first row.
//
// Failure: InputError with file and line for a line without a moment, or a value of a channel that
// was asked for which is no number; InputError with the file for a channel that never speaks (it
// lists those that do), and for no channel asked for. A channel that says "***" (not connected) has
// no value there.
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
