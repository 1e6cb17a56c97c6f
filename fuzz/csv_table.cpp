// `recording/csv_table.h`, the tables of others.
#include "recording/csv_table.h"

#include "fuzz/target.h"

namespace abbe::fuzz::csv_table {

void Read(Bytes bytes) {
  const InputFile file(bytes);
  const auto table =
      recording::ReadCsvTable(file.path(), {.columns = {{"x_mm", "x_m"}, {"ref_x_mm", "lS*0.5+lL"}},
                                            .where = {{"arm", "2"}},
                                            .kind = "linkage"});
  Require(table.rows() > 0 && table.columns.size() == 4, "time, two columns and flags");
}

}  // namespace abbe::fuzz::csv_table
