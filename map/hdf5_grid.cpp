#include <fmt/format.h>
#include <fmt/ranges.h>
#include <hdf5.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <map>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "failure/failure.h"
#include "map/export_grid.h"
#include "recording/hdf5_child.h"
#include "recording/output_file.h"
#include "recording/whole_file.h"

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

void PutNumbers(hid_t file, const char* name, const std::vector<hsize_t>& shape,
                const double* values, const std::filesystem::path& path) {
  const Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
                     H5Sclose);
  const Handle data(
      H5Dcreate2(file, name, H5T_IEEE_F64LE, space.id(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Dclose);
  errno = 0;
  if (H5Dwrite(data.id(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0) return;
  recording::ThrowWriteFailure(path.string(), "nothing was written");
}

// The content of a file, by name.
struct StoredValues {
  std::map<std::string, std::string> texts;
  std::map<std::string, std::vector<double>> numbers;
};

using Shape = std::vector<hsize_t>;

Shape SendNumbers(hid_t file, const std::string& name, int rank, const std::string& file_name,
                  const recording::Hdf5Sender& sender) {
  const recording::Hdf5Numbers data(file, name, rank, file_name);
  data.RequireStorage(file_name);
  std::vector<double> values(data.count());
  Need(H5Dread(data.id(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0,
       file_name);
  sender.Send('N', name);
  sender.Send('V', std::span<const double>(values));
  const Handle space(H5Dget_space(data.id()), H5Sclose);
  Shape shape(rank);
  H5Sget_simple_extent_dims(space.id(), shape.data(), nullptr);
  return shape;
}

// InputError unless these are numbers for each point of the grid.
void RequireShape(const std::string& name, const Shape& shape, const Shape& grid,
                  const std::string& file_name) {
  if (shape == grid) return;
  throw InputError(fmt::format("{}: {}: is of {}, the positions are of {} (z, y, x, 3)", file_name,
                               name, fmt::join(shape, " x "), fmt::join(grid, " x ")));
}

// Runs in the child: sends each name and then its numbers or its text.
void SendAll(const std::string& file_name, const recording::Hdf5Sender& sender) {
  const Handle properties = recording::FileProperties();
  const Handle file(H5Fopen(file_name.c_str(), H5F_ACC_RDONLY, properties.id()), H5Fclose);
  Need(file.good(), file_name);
  for (const char* name : {"machine", "chain", "positive", "scale"}) {
    if (H5Aexists(file.id(), name) == 0 && std::string_view(name) == "positive") continue;
    const std::string text = recording::TextAttribute(file.id(), name, file_name);
    sender.Send('T', name);
    sender.Send('t', text);
  }
  for (const char* name : {"tool_mm", "temperature_c"}) {
    SendNumbers(file.id(), name, 1, file_name, sender);
  }
  Shape grid{3};
  for (const char* name : kGridAxes) {
    grid.insert(grid.begin(), SendNumbers(file.id(), name, 1, file_name, sender)[0]);
  }
  for (const char* name : {"error_um", "u95_um"}) {
    const bool may_lack = std::string_view(name) == "u95_um";
    if (may_lack && H5Lexists(file.id(), name, H5P_DEFAULT) <= 0) continue;
    RequireShape(name, SendNumbers(file.id(), name, 4, file_name, sender), grid, file_name);
  }
}

StoredValues ReadAll(const std::filesystem::path& path) {
  StoredValues stored;
  std::string name;
  recording::ReadInChild(
      path, [&](const recording::Hdf5Sender& sender) { SendAll(path.string(), sender); },
      [&](char part, std::string_view bytes) {
        if (part == 'T' || part == 'N') name = bytes;
        if (part == 't') stored.texts[name] = bytes;
        if (part != 'V') return true;
        std::vector<double>& values = stored.numbers[name];
        const std::size_t before = values.size(), count = bytes.size() / sizeof(double);
        values.resize(before + count);
        std::memcpy(values.data() + before, bytes.data(), count * sizeof(double));
        return true;
      });
  return stored;
}

Eigen::Matrix3Xd VectorsOf(const std::vector<double>& values) {
  return 1e-6 * Eigen::Map<const Eigen::Matrix3Xd>(values.data(), 3, values.size() / 3);
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
  recording::WholeFile whole(path);
  const std::filesystem::path part = whole.PartToFill("\x89HDF\r\n\x1a\n");
  const Handle properties = recording::FileProperties();
  Handle file(H5Fcreate(part.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, properties.id()), H5Fclose);
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
  whole.Finish();
  return {path};
}

GridFile ReadHdf5Grid(const std::filesystem::path& path) {
  StoredValues stored = ReadAll(path);
  const auto& tool_mm = stored.numbers["tool_mm"];
  const auto& temperature = stored.numbers["temperature_c"];
  if (tool_mm.size() != 3 || temperature.size() != 1) {
    throw InputError(path.string() + ": tool_mm or temperature_c has a wrong size");
  }
  FileHeader header;
  header.machine = stored.texts["machine"];
  header.chain = stored.texts["chain"];
  header.positive = stored.texts["positive"];
  header.scale = stored.texts["scale"];
  header.tool = 1e-3 * Eigen::Vector3d(tool_mm.data());
  header.temperature = temperature[0];
  std::array<GridAxis, 3> axes;
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<double>& positions = stored.numbers[kGridAxes[k]];
    for (double& position : positions) position *= 1e-3;
    axes[k] = AxisOfPositions(positions, path.string());
  }
  return {header, MapGrid(axes, VectorsOf(stored.numbers["error_um"]),
                          VectorsOf(stored.numbers["u95_um"]))};
}

}  // namespace abbe::map
