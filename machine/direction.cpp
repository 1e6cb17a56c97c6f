#include "machine/direction.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/LU>

namespace abbe::machine {
namespace {

Eigen::Vector3d Direction(const settings::Table& table, const char* key, const std::string& text) {
  const bool reversed = text.size() == 2 && text.front() == '-';
  const char letter = text.empty() ? ' ' : text.back();
  if (text.size() != (reversed ? 2U : 1U) || letter < 'x' || letter > 'z') {
    throw table.Error(key, fmt::format("\"{}\" is not a machine direction; write \"x\", "
                                       "\"-z\" or another axis",
                                       text));
  }
  return (reversed ? -1.0 : 1.0) * Eigen::Vector3d::Unit(letter - 'x');
}

}  // namespace

Eigen::Vector3d ReadDirection(const settings::Table& table, const char* key,
                              const std::string& fallback) {
  return Direction(table, key, table.Text(key, fallback));
}

Eigen::Matrix3d ReadRotation(const settings::Table& table,
                             const std::vector<std::string>& fallback) {
  const auto names = table.Texts("rotation", 3, fallback);
  Eigen::Matrix3d R;
  for (int i = 0; i < 3; ++i) R.col(i) = Direction(table, "rotation", names[i]);
  if (R.determinant() != 1) {
    throw table.Error("rotation", fmt::format("must be a right-handed frame, as [\"{}\"]",
                                              fmt::join(fallback, "\", \"")));
  }
  return R;
}

}  // namespace abbe::machine
