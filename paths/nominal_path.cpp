#include "paths/nominal_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "failure/failure.h"
#include "settings/unit.h"

namespace abbe::paths {
namespace {

std::vector<std::string_view> Fields(std::string_view line) {
  std::vector<std::string_view> fields;
  while (true) {
    const std::size_t comma = std::min(line.find(','), line.size());
    std::string_view field = line.substr(0, comma);
    while (!field.empty() && std::isspace(static_cast<unsigned char>(field.front()))) {
      field.remove_prefix(1);
    }
    while (!field.empty() && std::isspace(static_cast<unsigned char>(field.back()))) {
      field.remove_suffix(1);
    }
    fields.push_back(field);
    if (comma == line.size()) return fields;
    line.remove_prefix(comma + 1);
  }
}

std::array<std::size_t, 3> Columns(std::string_view header, const std::string& file) {
  const std::vector<std::string_view> names = Fields(header);
  std::array<std::size_t, 3> columns{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string name = fmt::format("{}_mm", "xyz"[axis]);
    const auto found = std::ranges::find(names, name);
    if (found == names.end()) {
      throw InputError(fmt::format(
          "{}: has no column {}; a nominal path begins with a line x_mm,y_mm,z_mm", file, name));
    }
    columns[axis] = found - names.begin();
  }
  return columns;
}

Eigen::Vector3d Point(std::string_view line, const std::array<std::size_t, 3>& columns,
                      const std::string& place) {
  const std::vector<std::string_view> fields = Fields(line);
  Eigen::Vector3d point;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string_view text =
        columns[axis] < fields.size() ? fields[columns[axis]] : std::string_view();
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) {
      throw InputError(
          fmt::format("{}: {}_mm is \"{}\", a number is expected", place, "xyz"[axis], text));
    }
    point[axis] = value * settings::kMillimetre;
  }
  return point;
}

}  // namespace

Eigen::Matrix3Xd ReadNominalPath(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path)) {
    throw InputError(fmt::format(
        "{}: cannot be read: --test takes stepping, square, cap, articulation or a CSV file with a "
        "nominal path",
        path.string()));
  }
  std::vector<Eigen::Vector3d> points;
  std::array<std::size_t, 3> columns{};
  bool headed = false;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const std::vector<std::string_view> fields = Fields(line);
    if (fields.size() == 1 && fields[0].empty()) continue;
    if (fields[0].starts_with('#')) continue;
    if (headed) {
      points.push_back(Point(line, columns, fmt::format("{}:{}", path.string(), number)));
    } else {
      columns = Columns(line, path.string());
      headed = true;
    }
  }
  Eigen::Matrix3Xd nominal(3, points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    nominal.col(i) = points[i];
  }
  if (nominal.cols() < 2) {
    throw InputError(fmt::format("{}: {} points: a nominal path needs two at least", path.string(),
                                 points.size()));
  }
  return nominal;
}

}  // namespace abbe::paths
