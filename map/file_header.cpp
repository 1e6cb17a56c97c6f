#include "map/file_header.h"

#include <fmt/format.h>

#include <array>

#include "map/words.h"

namespace abbe::map {

FileHeader HeaderOf(const ErrorMap& map, const Eigen::Vector3d& p_TQ) {
  return {map.origin().machine, map.model().chain().Text(), p_TQ, map.origin().temperature,
          std::string(map.Scale())};
}

std::string HeaderText(const FileHeader& header, std::string_view mark) {
  std::string text;
  const auto add = [&](std::string_view key, const std::string& value) {
    text += fmt::format("{} {} = {}\n", mark, key, value);
  };
  add("machine", header.machine);
  add("chain", header.chain);
  add("tool_mm",
      fmt::format("{} {} {}", header.tool.x() * 1e3, header.tool.y() * 1e3, header.tool.z() * 1e3));
  add("temperature_c", fmt::format("{}", header.temperature));
  add("scale", header.scale);
  add("sign", "actual - nominal of the tool in the workpiece");
  return text;
}

void ReadComment(std::string_view comment, FileHeader& header) {
  const std::size_t equals = comment.find(" = ");
  if (equals == std::string_view::npos) return;
  const std::string_view key = Trimmed(comment.substr(0, equals));
  const std::string_view value = Trimmed(comment.substr(equals + 3));
  if (key == "machine") header.machine = value;
  if (key == "chain") header.chain = machine::Chain::Parse(value).Text();
  if (key == "scale") header.scale = value;
  if (key == "temperature_c") header.temperature = NumberOf(value, "temperature_c");
  if (key == "tool_mm") {
    const auto numbers = NumbersOf(value, "tool_mm");
    if (numbers.size() == 3) header.tool = Eigen::Vector3d(numbers.data()) * 1e-3;
  }
}

}  // namespace abbe::map
