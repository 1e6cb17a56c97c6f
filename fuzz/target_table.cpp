// `recording/target_table.h`.
#include "recording/target_table.h"

#include "fuzz/target.h"

namespace abbe::fuzz::target_table {

void Read(Bytes bytes) { recording::ReadTargetTable(InputFile(bytes).path(), "Y"); }

}  // namespace abbe::fuzz::target_table
