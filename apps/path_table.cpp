#include "apps/path_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "failure/failure.h"
#include "map/text_file.h"
#include "map/words.h"

namespace abbe::apps {

Eigen::Matrix3Xd ReadPathTable(const std::filesystem::path& file) {
  const std::string text = map::ReadWhole(file);
  map::Lines lines(text, file.string());
  std::vector<std::string_view> names;
  std::vector<double> values;
  for (std::string_view line; lines.Next(line);) {
    if (line.empty() || line.starts_with('#')) continue;
    const auto words = map::PartsOf(line, ',');
    if (names.empty()) names = words;
    if (words.size() != names.size()) {
      throw InputError(
          fmt::format("{}: {} values under {} columns", lines.Where(), words.size(), names.size()));
    }
    for (const std::string_view column : {"x_mm", "y_mm", "z_mm"}) {
      const auto at = std::find(names.begin(), names.end(), column);
      if (at == names.end()) {
        throw InputError(fmt::format("{}: there is no column {}", lines.Where(), column));
      }
      if (words == names) continue;
      values.push_back(1e-3 * map::NumberOf(words[at - names.begin()], lines.Where()));
    }
  }
  if (values.empty()) {
    throw InputError(
        fmt::format("{}: has no rows under x_mm, y_mm, z_mm; it may be cut off", file.string()));
  }
  return Eigen::Map<const Eigen::Matrix3Xd>(values.data(), 3, values.size() / 3);
}

}  // namespace abbe::apps
