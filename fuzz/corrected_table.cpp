// `compensation/corrected_table.h`: a table that was corrected is one that can be.
#include "compensation/corrected_table.h"

#include "fuzz/small_map.h"
#include "fuzz/target.h"

namespace abbe::fuzz::corrected_table {

void Read(Bytes bytes) {
  static const map::ErrorMap map = SmallMap();
  static const compensation::Corrector corrector(map, Eigen::Vector3d(0.0, 0.0, 0.1));
  compensation::CorrectTable(TextOf(bytes), "table.csv", corrector);
}

}  // namespace abbe::fuzz::corrected_table
