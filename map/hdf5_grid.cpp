#include <fmt/format.h>
#include <hdf5.h>

#include <array>
#include <string>
#include <system_error>
#include <utility>

#include "failure/failure.h"
#include "map/export_grid.h"
#include "recording/hdf5_handle.h"

namespace abbe::map {
namespace {

using recording::Handle;

constexpr std::array kGridAxes{"x_mm", "y_mm", "z_mm"};

void Need(bool is_good, const std::filesystem::path& path) {
  if (is_good) return;
  throw InputError(
      fmt::format("{}: {}; check the path and the file", path.string(), recording::Hdf5Reason()));
}

void PutText(hid_t file, const char* name, const std::string& value) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose), space(H5Screate(H5S_SCALAR), H5Sclose);
  H5Tset_size(type.id(), value.size() + 1);
  H5Tset_cset(type.id(), H5T_CSET_UTF8);
  const Handle attribute(H5Acreate2(file, name, type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose);
  H5Awrite(attribute.id(), type.id(), value.c_str());
}

std::string GetText(hid_t file, const char* name, const std::filesystem::path& path) {
  const Handle attribute(H5Aopen(file, name, H5P_DEFAULT), H5Aclose);
  Need(attribute.good(), path);
  const Handle type(H5Aget_type(attribute.id()), H5Tclose);
  std::string value(H5Tget_size(type.id()), '\0');
  Need(H5Aread(attribute.id(), type.id(), value.data()) >= 0, path);
  return value.substr(0, value.find('\0'));
}

void PutNumbers(hid_t file, const char* name, const std::vector<hsize_t>& shape,
                const double* values, const std::filesystem::path& path) {
  const Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
                     H5Sclose);
  const Handle data(
      H5Dcreate2(file, name, H5T_IEEE_F64LE, space.id(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Dclose);
  Need(H5Dwrite(data.id(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0, path);
}

std::vector<double> GetNumbers(hid_t file, const char* name, const std::filesystem::path& path) {
  const Handle data(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose);
  Need(data.good(), path);
  const Handle space(H5Dget_space(data.id()), H5Sclose);
  std::vector<double> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space.id())));
  Need(H5Dread(data.id(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0,
       path);
  return values;
}

Eigen::Matrix3Xd GetVectors(hid_t file, const char* name, const std::filesystem::path& path) {
  const auto values = GetNumbers(file, name, path);
  return 1e-6 * Eigen::Map<const Eigen::Matrix3Xd>(values.data(), 3,
                                                   static_cast<Eigen::Index>(values.size() / 3));
}

void PutGrid(hid_t file, const GridFile& content, const std::filesystem::path& path) {
  const auto& axes = content.grid.axes();
  std::vector<hsize_t> shape = {3};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::vector<double> positions = Millimetres(axes[k]);
    PutNumbers(file, kGridAxes[k], {positions.size()}, positions.data(), path);
    shape.insert(shape.begin(), positions.size());
  }
  const Eigen::Matrix3Xd error_um = content.grid.error() * 1e6;
  PutNumbers(file, "error_um", shape, error_um.data(), path);
  if (content.grid.u95().size() == 0) return;
  const Eigen::Matrix3Xd u95_um = content.grid.u95() * 1e6;
  PutNumbers(file, "u95_um", shape, u95_um.data(), path);
}

}  // namespace

Format::Paths WriteHdf5Grid(const ErrorMap& map, const ExportOptions& options,
                            const std::filesystem::path& path) {
  const recording::QuietHdf5 quiet;
  const GridFile content = GridFileOf(map, options);
  std::error_code error;
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), error);
  const std::string unfinished = path.string() + ".part";
  const Handle properties = recording::FileProperties();
  Handle file(H5Fcreate(unfinished.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, properties.id()), H5Fclose);
  Need(file.good(), path);
  const FileHeader& header = content.header;
  const Eigen::Vector3d tool_mm = header.tool * 1e3;
  PutText(file.id(), "machine", header.machine);
  PutText(file.id(), "chain", header.chain);
  PutText(file.id(), "positive", header.positive);
  PutText(file.id(), "scale", header.scale);
  PutText(file.id(), "unit", "um");
  PutText(file.id(), "sign", kSignOfPoints);
  PutText(file.id(), "frame", "axes of the workpiece; positions as the axes are commanded");
  PutNumbers(file.id(), "tool_mm", {3}, tool_mm.data(), path);
  PutNumbers(file.id(), "temperature_c", {1}, &header.temperature, path);
  PutGrid(file.id(), content, path);
  Need(file.CloseNow(), path);
  std::filesystem::rename(unfinished, path);
  return {path};
}

GridFile ReadHdf5Grid(const std::filesystem::path& path) {
  const recording::QuietHdf5 quiet;
  const Handle properties = recording::FileProperties();
  const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, properties.id()), H5Fclose);
  Need(file.good(), path);
  FileHeader header;
  header.machine = GetText(file.id(), "machine", path);
  header.chain = GetText(file.id(), "chain", path);
  header.positive = GetText(file.id(), "positive", path);
  header.scale = GetText(file.id(), "scale", path);
  const auto tool_mm = GetNumbers(file.id(), "tool_mm", path);
  const auto temperature = GetNumbers(file.id(), "temperature_c", path);
  if (tool_mm.size() != 3 || temperature.size() != 1) {
    throw InputError(path.string() + ": tool_mm or temperature_c has another size");
  }
  header.tool = 1e-3 * Eigen::Vector3d(tool_mm.data());
  header.temperature = temperature[0];
  std::array<GridAxis, 3> axes;
  for (std::size_t k = 0; k < 3; ++k) {
    auto positions = GetNumbers(file.id(), kGridAxes[k], path);
    for (double& position : positions) position *= 1e-3;
    axes[k] = AxisOfPositions(positions, path.string());
  }
  Eigen::Matrix3Xd u95;
  if (H5Lexists(file.id(), "u95_um", H5P_DEFAULT) > 0) u95 = GetVectors(file.id(), "u95_um", path);
  return {header, MapGrid(axes, GetVectors(file.id(), "error_um", path), std::move(u95))};
}

}  // namespace abbe::map
