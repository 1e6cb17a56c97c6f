// The grid for LinuxCNC's HAL component (`control/linuxcnc/abbe_grid.h`): one that is read has an
// error at its ends.
#include "fuzz/target.h"
#include "map/export_linuxcnc_hal.h"

namespace abbe::fuzz::map_linuxcnc_hal {

void Read(Bytes bytes) {
  const map::HalGrid file(InputFile(bytes).path());
  const abbe_grid& grid = file.grid();
  double error[3];
  Require(abbe_grid_error(&grid, grid.first, grid.tool, error) == 1,
          "the first point has an error");
  Require(abbe_grid_error(&grid, grid.highest, grid.tool, error) == 1, "the limit has an error");
}

}  // namespace abbe::fuzz::map_linuxcnc_hal
