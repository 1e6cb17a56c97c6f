// `recording/hole_table.h`.
#include "recording/hole_table.h"

#include "fuzz/target.h"

namespace abbe::fuzz::hole_table {

void Read(Bytes bytes) { recording::ReadHoleTable(InputFile(bytes).path(), 0.5); }

}  // namespace abbe::fuzz::hole_table
