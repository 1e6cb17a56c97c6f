#include <fmt/format.h>

#include <array>
#include <iterator>
#include <string>

#include "failure/failure.h"
#include "map/export_grid.h"
#include "map/text_file.h"
#include "map/words.h"

namespace abbe::map {
namespace {

constexpr std::string_view kColumns = "x_mm,y_mm,z_mm,ex_um,ey_um,ez_um";
constexpr std::string_view kUncertainties = ",u95x_um,u95y_um,u95z_um";

// The distinct positions of one column in order of appearance, `stride` rows apart.
std::vector<double> Positions(const std::vector<std::array<double, 9>>& rows, std::size_t column,
                              std::size_t stride) {
  std::vector<double> positions;
  for (std::size_t i = 0; i < rows.size(); i += stride) {
    if (!positions.empty() && rows[i][column] <= positions.back()) break;
    positions.push_back(rows[i][column]);
  }
  return positions;
}

}  // namespace

Format::Paths WriteCsvGrid(const ErrorMap& map, const ExportOptions& options,
                           const std::filesystem::path& path) {
  const GridFile file = GridFileOf(map, options);
  const bool has_u95 = file.grid.u95().size() > 0;
  std::string text = HeaderText(file.header, "#", {kSignOfPoints});
  text += kColumns;
  if (has_u95) text += kUncertainties;
  text += '\n';
  for (Eigen::Index i = 0; i < file.grid.size(); ++i) {
    const Eigen::Vector3d p = file.grid.Position(i) * 1e3, e = file.grid.error().col(i) * 1e6;
    fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{}", p.x(), p.y(), p.z(), e.x(), e.y(),
                   e.z());
    if (has_u95) {
      const Eigen::Vector3d u = file.grid.u95().col(i) * 1e6;
      fmt::format_to(std::back_inserter(text), ",{},{},{}", u.x(), u.y(), u.z());
    }
    text += '\n';
  }
  WriteWhole(text, path);
  return {path};
}

GridFile ReadCsvGrid(const std::filesystem::path& path) {
  const std::string text = ReadWhole(path);
  Lines lines(text, path.string());
  FileHeader header;
  std::size_t columns = 0;
  std::vector<std::array<double, 9>> rows;
  for (std::string_view line; lines.Next(line);) {
    if (line.starts_with('#')) {
      ReadComment(line.substr(1), header);
    } else if (columns == 0) {
      if (line != kColumns && line != std::string(kColumns) + std::string(kUncertainties)) {
        throw InputError(fmt::format("{}: expected the columns {}[{}]", lines.Where(), kColumns,
                                     kUncertainties));
      }
      columns = PartsOf(line, ',').size();
    } else {
      const auto words = PartsOf(line, ',');
      if (words.size() != columns) {
        throw InputError(
            fmt::format("{}: {} numbers for {} columns", lines.Where(), words.size(), columns));
      }
      std::array<double, 9> row{};
      for (std::size_t k = 0; k < columns; ++k) row[k] = NumberOf(words[k], lines.Where());
      rows.push_back(row);
    }
  }
  const auto axis = [&](std::size_t column, std::size_t stride) {
    std::vector<double> positions = Positions(rows, column, stride);
    for (double& position : positions) position *= 1e-3;
    return AxisOfPositions(positions, path.string());
  };
  const GridAxis x = axis(0, 1), y = axis(1, x.count), z = axis(2, x.count * y.count);
  const Eigen::Index count = rows.size();
  if (count != x.count * y.count * z.count) {
    throw InputError(fmt::format("{}: {} rows for a grid of {} x {} x {} points; it is cut off",
                                 path.string(), count, x.count, y.count, z.count));
  }
  Eigen::Matrix3Xd error(3, count), u95(3, columns == 9 ? count : 0);
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto& row = rows[i];
    error.col(i) = 1e-6 * Eigen::Vector3d(row[3], row[4], row[5]);
    if (columns == 9) u95.col(i) = 1e-6 * Eigen::Vector3d(row[6], row[7], row[8]);
  }
  return {header, MapGrid({x, y, z}, std::move(error), std::move(u95))};
}

}  // namespace abbe::map
