// Compensation tables of LinuxCNC (`map/export_axis_comp.h`).
#include "fuzz/target.h"
#include "map/export_axis_comp.h"

namespace abbe::fuzz::map_linuxcnc {

void Read(Bytes bytes) {
  const map::AxisCurve curve = map::ReadComp(InputFile(bytes).path());
  Require(!curve.positions.empty(), "a table has a row");
  curve.At(curve.positions.front() / 2 + curve.positions.back() / 2);
}

}  // namespace abbe::fuzz::map_linuxcnc
