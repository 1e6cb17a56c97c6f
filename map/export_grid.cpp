#include "map/export_grid.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "failure/failure.h"

namespace abbe::map {
namespace {

ErrorField FieldOfGrid(GridFile file) {
  return [grid = std::move(file.grid)](const Eigen::Vector3d& p) { return grid.Error(p); };
}

}  // namespace

GridFile GridFileOf(const ErrorMap& map, const ExportOptions& options) {
  return {HeaderOf(map, options.tool), SampleGrid(map, options.tool, options.counts)};
}

GridAxis AxisOfPositions(const std::vector<double>& positions, const std::string& where) {
  const Eigen::Index count = positions.size();
  if (count < 2) throw InputError(where + ": a grid needs at least two positions along each axis");
  const GridAxis axis{positions.front(), positions.back(), count};
  for (Eigen::Index i = 0; i < count; ++i) {
    // The file holds mm: allow for the rounding of the conversion.
    if (!(std::abs(positions[i] - axis.At(i)) <= 1e-9 * axis.Step())) {
      throw InputError(
          fmt::format("{}: position {} is not on a grid of equal steps", where, i + 1));
    }
  }
  return axis;
}

std::vector<double> Millimetres(const GridAxis& axis) {
  std::vector<double> positions(axis.count);
  for (Eigen::Index i = 0; i < axis.count; ++i) {
    positions[i] = axis.At(i) * 1e3;
  }
  return positions;
}

ErrorField ReadBackCsvGrid(const Format::Paths& files, const machine::Chain& /*chain*/) {
  return FieldOfGrid(ReadCsvGrid(files.front()));
}
ErrorField ReadBackJsonGrid(const Format::Paths& files, const machine::Chain& /*chain*/) {
  return FieldOfGrid(ReadJsonGrid(files.front()));
}
ErrorField ReadBackHdf5Grid(const Format::Paths& files, const machine::Chain& /*chain*/) {
  return FieldOfGrid(ReadHdf5Grid(files.front()));
}
ErrorField ReadBackVtkGrid(const Format::Paths& files, const machine::Chain& /*chain*/) {
  return FieldOfGrid(ReadVtkGrid(files.front()));
}

}  // namespace abbe::map
