// `recording/ballbar.h`: tables in CSV as circles.
#include "recording/ballbar.h"

#include "fuzz/target.h"
#include "recording/csv_table.h"

namespace abbe::fuzz::ballbar {

void Read(Bytes bytes) {
  const recording::Recording table = recording::ReadCsvTable(
      InputFile(bytes).path(),
      {.columns = {{"angle_deg", "angle"}, {"deviation_um", "dev"}}, .kind = "ballbar"});
  recording::BallbarOf(table, {.radius_mm = 150.0, .plane = "ZX", .feed_mm_min = 1000.0});
}

}  // namespace abbe::fuzz::ballbar
