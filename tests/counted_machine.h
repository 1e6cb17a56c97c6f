// Machines of any chain, counted as their carriages go or after ISO 841, for tests on the rig.
#pragma once

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <regex>
#include <string>

#include "folders.h"
#include "settings/document.h"

namespace abbe::tests {

// The demonstration machine with another chain. Counted as the tool goes, an axis that carries the
// workpiece shows minus where its carriage stands, and its travel is -60 to 0.
inline settings::Document MachineOf(const std::string& chain, bool as_tool) {
  std::ifstream file(DemoMillFile());
  std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto replace = [&](const std::string& from, const std::string& to) {
    text = std::regex_replace(text, std::regex(from), to);
  };
  replace("\\[w X Y b Z t\\]", chain);
  replace("positive = \"carriage\"\n", "");
  replace("step_mm = 1.0", "step_mm = 4.0");
  replace("passes = 5", "passes = 2");
  for (const char axis : std::string("XYZ")) {
    if (chain.find(axis) > chain.find('b')) continue;
    const std::string travel = as_tool ? "[-60.0, 0.0]" : "[0.0, 60.0]";
    const std::string head = fmt::format("\\[axis.{}\\]\ntravel_mm = \\[0.0, 60.0\\]", axis);
    replace(head, fmt::format("[axis.{}]\ntravel_mm = {}\npositive = \"{}\"", axis, travel,
                              as_tool ? "tool" : "carriage"));
    if (!as_tool) continue;
    replace(fmt::format("\\[sweep.{}\\]\nfirst_mm = 0.0\nlast_mm = 60.0", axis),
            fmt::format("[sweep.{}]\nfirst_mm = -60.0\nlast_mm = 0.0", axis));
  }
  return settings::Document::Parse(text, as_tool ? "iso841.toml" : "carriage.toml");
}

}  // namespace abbe::tests
