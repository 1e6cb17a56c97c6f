// Formats of the map on a grid, for one tool: CSV, JSON, HDF5, VTK.
//
// Positions x_mm, y_mm, z_mm; errors and their U95 = 2 u in um, three components each; x runs
// fastest. All numbers in the shortest form that reads back the same (HDF5: binary).
//
//   csv    "# key = value" lines (file_header.h), then
//          x_mm,y_mm,z_mm,ex_um,ey_um,ez_um,u95x_um,u95y_um,u95z_um
//   json   {"abbe-map-grid": 1, "machine": ..., "x_mm": [...], ...,
//           "error_um": [[ex, ey, ez], ...], "u95_um": [...]}
//   hdf5   datasets x_mm, y_mm, z_mm, error_um and u95_um [z, y, x, 3]; attributes of the file
//   vtk    a rectilinear grid, .vtr, XML with ascii arrays: error_um, u95_um as point data
// Without an uncertainty in the map the u95 columns and arrays are left out.
// Failure: InputError with file and line or key; a truncated file is refused.
// Source: VTK: the public description of its XML formats.
#pragma once

#include "map/exporter.h"

namespace abbe::map {

struct GridFile {
  FileHeader header;
  MapGrid grid;
};

// Header and grid of a map, for the writers.
GridFile GridFileOf(const ErrorMap& map, const ExportOptions& options);

// The positions along one axis as a GridAxis. InputError, beginning with `where`, unless the steps
// are equal.
GridAxis AxisOfPositions(const std::vector<double>& positions, const std::string& where);

// The positions of an axis in mm, as in the files.
std::vector<double> Millimetres(const GridAxis& axis);

// Each writer returns the files written.
Format::Paths WriteCsvGrid(const ErrorMap& map, const ExportOptions& options,
                           const std::filesystem::path& path);
Format::Paths WriteJsonGrid(const ErrorMap& map, const ExportOptions& options,
                            const std::filesystem::path& path);
Format::Paths WriteHdf5Grid(const ErrorMap& map, const ExportOptions& options,
                            const std::filesystem::path& path);
Format::Paths WriteVtkGrid(const ErrorMap& map, const ExportOptions& options,
                           const std::filesystem::path& path);

// The readers of the same formats: the grid, or its interpolated error for the exporter's
// comparison.
GridFile ReadCsvGrid(const std::filesystem::path& file);
GridFile ReadJsonGrid(const std::filesystem::path& file);
GridFile ReadHdf5Grid(const std::filesystem::path& file);
GridFile ReadVtkGrid(const std::filesystem::path& file);

ErrorField ReadBackCsvGrid(const Format::Paths& files, const machine::Chain& chain);
ErrorField ReadBackJsonGrid(const Format::Paths& files, const machine::Chain& chain);
ErrorField ReadBackHdf5Grid(const Format::Paths& files, const machine::Chain& chain);
ErrorField ReadBackVtkGrid(const Format::Paths& files, const machine::Chain& chain);

}  // namespace abbe::map
