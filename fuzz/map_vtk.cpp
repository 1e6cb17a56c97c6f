// A map on a grid as vtk (`map/export_grid.h`): a grid that is read can be used.
#include "fuzz/target.h"
#include "map/export_grid.h"

namespace abbe::fuzz::map_vtk {

void Read(Bytes bytes) {
  const map::GridFile file = map::ReadVtkGrid(InputFile(bytes).path());
  const auto& axes = file.grid.axes();
  file.grid.Error({axes[0].At(0), axes[1].At(axes[1].count / 2), axes[2].last});
}

}  // namespace abbe::fuzz::map_vtk
