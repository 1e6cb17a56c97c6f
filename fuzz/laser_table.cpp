// `recording/laser_table.h`.
#include "recording/laser_table.h"

#include "fuzz/target.h"

namespace abbe::fuzz::laser_table {

void Read(Bytes bytes) { recording::ReadLaserTable(InputFile(bytes).path(), ""); }

}  // namespace abbe::fuzz::laser_table
