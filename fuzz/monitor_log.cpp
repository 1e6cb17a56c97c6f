// `recording/monitor_log.h`, as run and as turning shaft.
#include "recording/monitor_log.h"

#include "failure/failure.h"
#include "fuzz/target.h"

namespace abbe::fuzz::monitor_log {

void Read(Bytes bytes) {
  const InputFile file(bytes);
  recording::IsMonitorLog(file.path());
  try {
    recording::ReadMonitorLog(file.path(), {{"shaft_deg", "B"}, {"gap_1_mm", "A"}}, {30.0});
  } catch (const InputError&) {  // lacks a channel of a shaft, perhaps not this one
  }
  recording::ReadMonitorLog(file.path(), {{"gap_1_mm", "A"}});
}

}  // namespace abbe::fuzz::monitor_log
