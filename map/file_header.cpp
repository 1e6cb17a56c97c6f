#include "map/file_header.h"

#include <fmt/format.h>

#include "failure/failure.h"
#include "map/words.h"

namespace abbe::map {

FileHeader HeaderOf(const ErrorMap& map, const Eigen::Vector3d& p_TQ) {
  const machine::Chain& chain = map.model().chain();
  return {.machine = map.origin().machine,
          .chain = chain.Text(),
          .positive = chain.PositiveText(),
          .tool = p_TQ,
          .temperature = map.origin().temperature,
          .scale = std::string(map.Scale())};
}

std::string HeaderText(const FileHeader& header, std::string_view mark,
                       const std::vector<std::string>& sign) {
  std::string text;
  const auto add = [&](std::string_view key, const std::string& value) {
    text += fmt::format("{} {} = {}\n", mark, key, value);
  };
  add("machine", header.machine);
  add("chain", header.chain);
  add("positive", header.positive);
  add("tool_mm",
      fmt::format("{} {} {}", header.tool.x() * 1e3, header.tool.y() * 1e3, header.tool.z() * 1e3));
  add("temperature_c", fmt::format("{}", header.temperature));
  add("scale", header.scale);
  for (const std::string& line : sign) add("sign", line);
  return text;
}

machine::Chain ChainOf(const FileHeader& header) {
  if (header.chain.empty()) {
    throw InputError(
        "the file does not state the order of the axes; give it with --chain \"[w X Y b Z t]\"");
  }
  machine::Chain chain = machine::Chain::Parse(header.chain);
  chain.ReadPositive(header.positive, "give --positive \"...\" of X, Y and Z");
  return chain;
}

void ReadComment(std::string_view comment, FileHeader& header) {
  const std::size_t equals = comment.find(" = ");
  if (equals == std::string_view::npos) return;
  const std::string_view key = Trimmed(comment.substr(0, equals));
  const std::string_view value = Trimmed(comment.substr(equals + 3));
  if (key == "machine") header.machine = value;
  if (key == "chain") header.chain = machine::Chain::Parse(value).Text();
  if (key == "positive") header.positive = value;
  if (key == "scale") header.scale = value;
  if (key == "temperature_c") header.temperature = NumberOf(value, "temperature_c");
  if (key == "tool_mm") {
    const auto numbers = NumbersOf(value, "tool_mm");
    if (numbers.size() == 3) header.tool = Eigen::Vector3d(numbers.data()) * 1e-3;
  }
}

}  // namespace abbe::map
