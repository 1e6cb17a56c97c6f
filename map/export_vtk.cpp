#include <fmt/format.h>

#include <iterator>
#include <string>
#include <utility>

#include "failure/failure.h"
#include "map/export_grid.h"
#include "map/text_file.h"
#include "map/words.h"

namespace abbe::map {
namespace {

constexpr std::array kVtkAxes{"x_mm", "y_mm", "z_mm"};

template <typename Values>
void AddArray(std::string& text, std::string_view name, int components, const Values& values) {
  fmt::format_to(std::back_inserter(text),
                 "<DataArray type=\"Float64\" Name=\"{}\" NumberOfComponents=\"{}\" "
                 "format=\"ascii\">\n",
                 name, components);
  int in_line = 0;
  for (const double value : values) {
    fmt::format_to(std::back_inserter(text), "{}{}", value,
                   ++in_line % components == 0 ? '\n' : ' ');
  }
  text += "</DataArray>\n";
}

std::vector<double> InMicrometres(const Eigen::Matrix3Xd& values) {
  const Eigen::Matrix3Xd scaled = values * 1e6;
  return {scaled.data(), scaled.data() + scaled.size()};
}

// The header as an XML comment, which must not contain "--".
std::string CommentOf(const FileHeader& header) {
  std::string text = HeaderText(header, "", {kSignOfPoints});
  for (std::size_t at; (at = text.find("--")) != std::string::npos;) text.replace(at, 2, "- -");
  return "<!--\n" + text + "-->\n";
}

// The numbers of the array with this name; empty if there is none.
std::vector<double> ArrayNamed(const std::string& text, const std::string& name,
                               const std::string& where) {
  const std::size_t tag = text.find("Name=\"" + name + "\"");
  if (tag == std::string::npos) return {};
  const std::size_t begin = text.find('>', tag), end = text.find("</DataArray>", tag);
  if (end == std::string::npos || text.find("format=\"ascii\"", tag) > begin) {
    throw InputError(fmt::format("{}: the array {} is cut off or not ascii", where, name));
  }
  return NumbersOf(std::string_view(text).substr(begin + 1, end - begin - 1), where);
}

Eigen::Matrix3Xd OfMicrometres(const std::vector<double>& values, const std::string& where) {
  if (values.size() % 3 != 0) throw InputError(where + ": an array of vectors lacks a component");
  return 1e-6 * Eigen::Map<const Eigen::Matrix3Xd>(values.data(), 3, values.size() / 3);
}

}  // namespace

Format::Paths WriteVtkGrid(const ErrorMap& map, const ExportOptions& options,
                           const std::filesystem::path& path) {
  const GridFile file = GridFileOf(map, options);
  const auto& axes = file.grid.axes();
  const std::string extent =
      fmt::format("0 {} 0 {} 0 {}", axes[0].count - 1, axes[1].count - 1, axes[2].count - 1);
  std::string text = fmt::format(
      "<?xml version=\"1.0\"?>\n{}<VTKFile type=\"RectilinearGrid\" version=\"0.1\" "
      "byte_order=\"LittleEndian\">\n<RectilinearGrid WholeExtent=\"{}\">\n<Piece Extent=\"{}\">\n"
      "<PointData Vectors=\"error_um\">\n",
      CommentOf(file.header), extent, extent);
  AddArray(text, "error_um", 3, InMicrometres(file.grid.error()));
  if (file.grid.u95().size() > 0) AddArray(text, "u95_um", 3, InMicrometres(file.grid.u95()));
  text += "</PointData>\n<Coordinates>\n";
  for (std::size_t k = 0; k < 3; ++k) {
    AddArray(text, kVtkAxes[k], 1, Millimetres(axes[k]));
  }
  text += "</Coordinates>\n</Piece>\n</RectilinearGrid>\n</VTKFile>\n";
  WriteWhole(text, path);
  return {path};
}

GridFile ReadVtkGrid(const std::filesystem::path& path) {
  const std::string text = ReadWhole(path), where = path.string();
  if (text.find("type=\"RectilinearGrid\"") == std::string::npos ||
      text.find("</VTKFile>") == std::string::npos) {
    throw InputError(where + ": is not a complete VTK file of a rectilinear grid");
  }
  FileHeader header;
  Lines lines(text, where);
  for (std::string_view line; lines.Next(line) && line != "-->";) ReadComment(line, header);
  std::array<GridAxis, 3> axes;
  for (std::size_t k = 0; k < 3; ++k) {
    auto positions = ArrayNamed(text, kVtkAxes[k], where);
    for (double& position : positions) position *= 1e-3;
    axes[k] = AxisOfPositions(positions, where);
  }
  return {header, MapGrid(axes, OfMicrometres(ArrayNamed(text, "error_um", where), where),
                          OfMicrometres(ArrayNamed(text, "u95_um", where), where))};
}

}  // namespace abbe::map
