// The map for LinuxCNC's HAL component control/linuxcnc/abbe_map.comp: a grid that it reads, for
// any tool, and a HAL file that loads and connects it.
//
// NAME.hal and, beside it, NAME.grid, a text of numbers in mm, um and urad:
//
//   abbe-map-grid 1
//   sense 1 -1 1                      ToolSense of X, Y, Z
//   tool_mm 0 0 -80                   p_TQ of a tool whose length offset is zero
//   x_mm 0 60 31 -0.1 60.1            first, last, points, limits; then y_mm, z_mm
//   1.25 -0.5 3 10.5 -2 0.25          a point: error for p_TQ = 0, turn; x fastest
//   end
//
// Lines that begin with # are comments.
// Frames: the error in W and the turn of the tool in it; error for p_TQ = error + turn x p_TQ.
// Units: SI here. Failure: InputError for more points than the component takes, for a name that HAL
// cannot hold, for errors above 10 mm, which the component refuses, and for files that the
// component would refuse, with its own reason.
// Source: own.
// Validity: exact at the points for the tool of the options; for one that is longer by l it leaves
// out half the square of the turn times l: 0.5 nm for 100 urad and 100 mm.
#pragma once

#include "control/linuxcnc/abbe_grid.h"
#include "map/exporter.h"

namespace abbe::map {

Format::Paths WriteLinuxcncHal(const ErrorMap& map, const ExportOptions& options,
                               const std::filesystem::path& path);

// The grid as the component reads it; its memory is that of the object.
class HalGrid {
 public:
  explicit HalGrid(const std::filesystem::path& file);
  ~HalGrid() { abbe_grid_free(&grid_); }
  HalGrid(const HalGrid&) = delete;
  HalGrid& operator=(const HalGrid&) = delete;

  const abbe_grid& grid() const { return grid_; }
  // The error in W for the tool of the file, m. InputError outside the limits.
  Eigen::Vector3d Error(const Eigen::Vector3d& position) const;

 private:
  abbe_grid grid_ = {};
};

ErrorField ReadBackLinuxcncHal(const Format::Paths& files, const machine::Chain& chain);

}  // namespace abbe::map
