// `compensation/nc_correction.h`: what is written can be read again, as moves of the same program.
#include <algorithm>

#include "compensation/nc_correction.h"
#include "fuzz/small_map.h"
#include "fuzz/target.h"

namespace abbe::fuzz::nc_program {

// Every line of `text` with its number.
template <typename Use>
void EachLine(std::string_view text, const Use& use) {
  std::size_t number = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    use(text.substr(0, end), ++number);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
}

// Every loop ends within these bounds, and so does the time for an input.
constexpr std::size_t kMostSteps = 2000;
constexpr double kMostLines = 20000;

void Read(Bytes bytes) {
  static const map::ErrorMap map = SmallMap();
  static const Eigen::Vector3d tool(0.0, 0.0, 0.1);
  static const compensation::Corrector corrector(map, tool);
  compensation::NcOptions options;
  options.limits = {.chord = 1e-5, .length = 0.05};
  options.start = Eigen::Vector3d::Constant(0.1);
  options.p_TQ_gauge = tool;
  options.tables.tools = {{1, {{0.0, 0.0, 20.0}, 6.0}}};
  options.tables.parameters = std::map<int, double>{{5161, 10.0}, {5241, 5.0}, {5263, 5.0}};
  options.deletes_blocks = false;
  options.most_steps = kMostSteps;
  options.most_lines = kMostLines;
  std::string out;
  compensation::NcSource source("", std::string(TextOf(bytes)));
  compensation::CorrectProgram(corrector, options, source,
                               [&](std::string_view piece) { out += piece; });
  compensation::NcBlock block;
  EachLine(out, [&](std::string_view line, std::size_t number) {
    if (line.starts_with("O<kept")) return;  // a branch of the control
    compensation::ReadBlock(line, number, compensation::NcParameters(), block);
  });
}

}  // namespace abbe::fuzz::nc_program
