#include "map/export_linuxcnc_hal.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>

#include "failure/failure.h"
#include "map/file_header.h"
#include "map/text_file.h"
#include "settings/unit.h"

namespace abbe::map {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using settings::kMicrometre;
using settings::kMicroradian;
using settings::kMillimetre;

// HAL splits at blanks and reads # [ $ ( as its own.
constexpr std::string_view kHalLetters =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-";

void RefuseForHal(const ExportOptions& options, const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  if (name.find_first_not_of(kHalLetters) != std::string::npos) {
    throw InputError(
        fmt::format("{}: a HAL file cannot name \"{}\"; use letters, digits, . _ and - in --out",
                    path.string(), name));
  }
  if (path.extension() == ".grid") {
    throw InputError(path.string() + ": is the name of the grid; give that of the .hal in --out");
  }
  const double points = 1.0 * static_cast<double>(options.counts[0]) *
                        static_cast<double>(options.counts[1]) *
                        static_cast<double>(options.counts[2]);
  if (points > abbe_grid_most) {
    throw InputError(fmt::format(
        "{:.0f} points; the component of LinuxCNC takes {:.0f}: give fewer with --points", points,
        abbe_grid_most));
  }
}

// The values of the points: the error for p_TQ = 0 below which the turn times the tool of the
// options leaves the error of that tool exactly; the turn.
Eigen::Matrix<double, ABBE_GRID_VALUES, Eigen::Dynamic> ValuesOf(const ErrorMap& map,
                                                                 const Vector3d& tool,
                                                                 const Matrix3Xd& positions) {
  const auto at = [&](const Vector3d& p_TQ) -> Matrix3Xd {
    return map.model().Errors(positions, p_TQ);
  };
  const Matrix3Xd zero = at(Vector3d::Zero());
  // The error is affine in p_TQ: a column of its derivative for each axis.
  const std::array<Matrix3Xd, 3> by_tool = {
      at(Vector3d::UnitX()) - zero, at(Vector3d::UnitY()) - zero, at(Vector3d::UnitZ()) - zero};
  Eigen::Matrix<double, ABBE_GRID_VALUES, Eigen::Dynamic> values(ABBE_GRID_VALUES,
                                                                 positions.cols());
  values.topRows<3>() = at(tool);
  values.row(3) = (by_tool[1].row(2) - by_tool[2].row(1)) / 2;
  values.row(4) = (by_tool[2].row(0) - by_tool[0].row(2)) / 2;
  values.row(5) = (by_tool[0].row(1) - by_tool[1].row(0)) / 2;
  for (Eigen::Index i = 0; i < values.cols(); ++i) {
    const Vector3d turn = values.col(i).tail<3>();
    values.col(i).head<3>() -= turn.cross(tool);
  }
  return values;
}

void RefuseLarge(const Matrix3Xd& errors) {
  const double largest = errors.cwiseAbs().maxCoeff() / kMillimetre;
  if (largest < abbe_grid_largest) return;
  throw InputError(
      fmt::format("the map has an error of {:.3g} mm; the component of LinuxCNC applies none of "
                  "{:.0f} mm or more: check the map",
                  largest, abbe_grid_largest));
}

std::string GridText(const ErrorMap& map, const ExportOptions& options) {
  const MapGrid grid = SampleErrors(map, options.tool, options.counts);
  RefuseLarge(grid.error());
  Matrix3Xd positions(3, grid.size());
  for (Eigen::Index i = 0; i < grid.size(); ++i) positions.col(i) = grid.Position(i);
  const Vector3d senses = map.model().chain().ToolSenses();
  const Vector3d tool = options.tool / kMillimetre;
  std::string text = fmt::format("abbe-map-grid 1\nsense {} {} {}\ntool_mm {} {} {}\n", senses.x(),
                                 senses.y(), senses.z(), tool.x(), tool.y(), tool.z());
  const auto limits = map.Limits();
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    const GridAxis& along = grid.axes()[axis];
    text += fmt::format("{}_mm {} {} {} {} {}\n", "xyz"[axis], along.first / kMillimetre,
                        along.last / kMillimetre, along.count,
                        std::min(limits[axis].first, along.first) / kMillimetre,
                        std::max(limits[axis].last, along.last) / kMillimetre);
  }
  text += HeaderText(HeaderOf(map, options.tool), "#",
                     {"error of the tool in the workpiece, actual - nominal, um, for the tool "
                      "point in the reference point, and its turn, urad; x fastest"});
  const auto values = ValuesOf(map, options.tool, positions);
  for (Eigen::Index i = 0; i < values.cols(); ++i) {
    const auto v = values.col(i);
    text += fmt::format("{:.6f} {:.6f} {:.6f} {:.6f} {:.6f} {:.6f}\n", v[0] / kMicrometre,
                        v[1] / kMicrometre, v[2] / kMicrometre, v[3] / kMicroradian,
                        v[4] / kMicroradian, v[5] / kMicroradian);
  }
  return text + "end\n";
}

std::string HalText(const ErrorMap& map, const std::string& grid) {
  std::string machine = map.origin().machine;
  std::replace(machine.begin(), machine.end(), '\n', ' ');
  std::string text = fmt::format(
      "# The error map of {}, applied by LinuxCNC. See docs/linuxcnc.md of abbe.\n"
      "# In the INI file: HALFILE = this file, behind the one that loads motmod;\n"
      "# OFFSET_AV_RATIO = 0.1 in [AXIS_X], [AXIS_Y] and [AXIS_Z].\n"
      "loadrt abbe_map grid={}\n"
      "addf abbe-map servo-thread\n"
      "setp abbe-map.unit-mm 1    # mm in a machine unit; 25.4 where LINEAR_UNITS = inch\n"
      "setp abbe-map.rate 0.5     # most speed of an offset, mm/s\n"
      "net abbe-on motion.motion-enabled => abbe-map.machine-on\n"
      "net abbe-homed motion.is-all-homed => abbe-map.homed\n",
      machine, grid);
  for (const char axis : {'x', 'y', 'z'}) {
    text += fmt::format(
        "net abbe-{0} axis.{0}.pos-cmd => abbe-map.{0}\n"
        "net abbe-tool-{0} motion.tooloffset.{0} => abbe-map.tool-{0}\n"
        "net abbe-counts-{0} abbe-map.{0}-counts => axis.{0}.eoffset-counts\n"
        "net abbe-eoffset-{0} axis.{0}.eoffset => abbe-map.{0}-eoffset\n"
        "net abbe-scale abbe-map.scale => axis.{0}.eoffset-scale\n"
        "net abbe-eoffset abbe-map.eoffset-enable => axis.{0}.eoffset-enable\n",
        axis);
  }
  return text +
         "# Applied from the first homing on. A switch or a program decides instead with\n"
         "#   net abbe-enable motion.digital-out-00 => abbe-map.enable\n"
         "setp abbe-map.enable 1\n"
         "# Feed waits while the map is not applied, also for the offset of another tool:\n"
         "#   net abbe-wait abbe-map.not-applied => motion.feed-inhibit\n";
}

}  // namespace

Format::Paths WriteLinuxcncHal(const ErrorMap& map, const ExportOptions& options,
                               const std::filesystem::path& path) {
  RefuseForHal(options, path);
  std::filesystem::path grid = path;
  grid.replace_extension(".grid");
  WriteWhole(GridText(map, options), grid);
  WriteWhole(HalText(map, grid.filename().string()), path);
  return {path, grid};
}

HalGrid::HalGrid(const std::filesystem::path& file) {
  char reason[ABBE_GRID_REASON];
  if (abbe_grid_read(file.string().c_str(), &grid_, reason) == 0) throw InputError(reason);
}

Vector3d HalGrid::Error(const Vector3d& position) const {
  const Vector3d at = position / kMillimetre;
  Vector3d error;
  if (abbe_grid_error(&grid_, at.data(), grid_.tool, error.data()) == 0) {
    throw InputError(fmt::format("X {:.6g} Y {:.6g} Z {:.6g} mm is beyond the limits of the grid",
                                 at.x(), at.y(), at.z()));
  }
  return error * kMillimetre;
}

ErrorField ReadBackLinuxcncHal(const Format::Paths& files, const machine::Chain& /*chain*/) {
  const auto grid = std::make_shared<const HalGrid>(files.at(1));
  return [grid](const Vector3d& position) { return grid->Error(position); };
}

}  // namespace abbe::map
