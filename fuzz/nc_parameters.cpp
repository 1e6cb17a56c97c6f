// Parameters of a control, `compensation/nc_tables.h`: offsets come of any of them.
#include "compensation/nc_tables.h"
#include "fuzz/target.h"

namespace abbe::fuzz::nc_parameters {

void Read(Bytes bytes) {
  const InputFile file(bytes);
  compensation::NcTables tables;
  tables.parameters = compensation::ReadParameters(file.path());
  const compensation::NcOffsets offsets = compensation::OffsetsOf(tables);
  Require(offsets.active >= 0 && offsets.active < compensation::kSystems, "a system is active");
}

}  // namespace abbe::fuzz::nc_parameters
