#include "apps/path_table.h"

#include <string>
#include <vector>

#include "compensation/position_table.h"
#include "map/text_file.h"

namespace abbe::apps {

Eigen::Matrix3Xd ReadPathTable(const std::filesystem::path& file) {
  const std::string text = map::ReadWhole(file);
  std::vector<double> values;
  for (compensation::PositionTable table(text, file.string()); table.Next();) {
    if (!table.IsRow()) continue;
    const Eigen::Vector3d& position = table.Position();
    values.insert(values.end(), position.data(), position.data() + 3);
  }
  return Eigen::Map<const Eigen::Matrix3Xd>(values.data(), 3, values.size() / 3);
}

}  // namespace abbe::apps
