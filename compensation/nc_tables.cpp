#include "compensation/nc_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <string_view>

#include "compensation/nc_block.h"
#include "compensation/nc_expression.h"
#include "failure/failure.h"
#include "failure/located.h"
#include "map/text_file.h"
#include "settings/ini_text.h"

namespace abbe::compensation {
namespace {

// The numbers of the first coordinate of G28, G30, G92 and of G54; 20 a system.
constexpr int kHome[2] = {5161, 5181}, kG92Acts = 5210, kG92 = 5211, kActive = 5220,
              kFirstSystem = 5221, kSystemStep = 20, kRotationBehind = 9;
constexpr int kLargestTool = 1'000'000;

using UseLine = std::function<void(std::string_view, std::size_t)>;

void EachTableLine(const std::filesystem::path& path, const UseLine& use) {
  const std::string text = map::ReadWhole(path);
  std::string_view rest = text;
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    line = line.substr(0, line.find(';'));
    if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    Located(path.string(), [&] { use(line, number); });
  }
}

const NcParameters kEmpty;

double PlainNumber(NcCursor& cursor) {
  const std::string_view rest = cursor.Rest();
  const auto refuse = [&] {
    cursor.Refuse(fmt::format("\"{}\" is not a number", rest.substr(0, 10)));
  };
  const char first = cursor.Peek();
  if (first == '#' || first == '[' || !cursor.IsAtValue()) refuse();
  const double value = cursor.Value();
  if (!std::isfinite(value)) refuse();  // -#2 is known only at the control
  return value;
}

}  // namespace

std::map<int, double> ReadParameters(const std::filesystem::path& path) {
  std::map<int, double> values;
  EachTableLine(path, [&](std::string_view line, std::size_t number) {
    NcCursor cursor(line, number, kEmpty);
    const double index = PlainNumber(cursor), value = PlainNumber(cursor);
    constexpr double kLast = 5602;
    if (cursor.Peek() != '\0' || !(index >= 1.0 && index <= kLast) || index != std::round(index)) {
      cursor.Refuse("not \"number value\" of a parameter of LinuxCNC");
    }
    if (!values.emplace(static_cast<int>(index), value).second) {
      cursor.Refuse(fmt::format("parameter {} is given twice", index));
    }
  });
  return values;
}

std::map<int, NcTool> ReadTools(const std::filesystem::path& path) {
  std::map<int, NcTool> tools;
  EachTableLine(path, [&](std::string_view line, std::size_t line_number) {
    NcCursor cursor(line, line_number, kEmpty);
    NcTool tool;
    double number = -1.0;
    while (cursor.Peek() != '\0') {
      const char letter = cursor.Peek();
      cursor.Skip(1);
      const double value = PlainNumber(cursor);
      if (letter == 'T') number = value;
      if (letter == 'D') tool.diameter = value;
      if (letter == 'Q') tool.orientation = static_cast<int>(std::clamp(value, 0.0, 9.0));
      if (letter >= 'X' && letter <= 'Z') tool.offset[letter - 'X'] = value;
      if (std::string_view("TPDXYZABCUVWIJQ").find(letter) == std::string_view::npos) {
        cursor.Refuse(fmt::format("{} is no word of a tool table", letter));
      }
    }
    if (!(number >= 0.0 && number <= kLargestTool) || number != std::round(number)) {
      cursor.Refuse("a tool without its number T");
    }
    if (!tools.emplace(static_cast<int>(number), tool).second) {
      cursor.Refuse(fmt::format("tool {} is given twice", number));
    }
  });
  return tools;
}

std::map<std::string, double> ReadIniNumbers(const std::filesystem::path& path) {
  std::map<std::string, double> numbers;
  for (const auto& [key, value] : settings::ParseIni(map::ReadWhole(path), path.string())) {
    std::string_view digits = value;
    if (digits.starts_with('+')) digits.remove_prefix(1);
    double number = 0.0;
    const char* const last = digits.data() + digits.size();
    const auto [end, error] = std::from_chars(digits.data(), last, number);
    if (error == std::errc() && end == last) numbers.emplace(key, number);
  }
  return numbers;
}

NcOffsets OffsetsOf(const NcTables& tables) {
  NcOffsets offsets;
  offsets.is_known[0] = true;  // G54, which the caller may set
  if (!tables.parameters) return offsets;
  const auto value = [&](int number) {
    const auto found = tables.parameters->find(number);
    return found == tables.parameters->end() ? 0.0 : found->second;
  };
  const auto vector = [&](int first) {
    return Eigen::Vector3d(tables.unit * value(first), tables.unit * value(first + 1),
                           tables.unit * value(first + 2));
  };
  for (int i = 0; i < kSystems; ++i) {
    offsets.systems[i] = vector(kFirstSystem + i * kSystemStep);
    offsets.rotations[i] =
        value(kFirstSystem + i * kSystemStep + kRotationBehind) * std::numbers::pi / 180.0;
  }
  offsets.is_known.fill(true);
  const double active = value(kActive);
  offsets.active = active >= 1.0 && active <= kSystems ? static_cast<int>(active) - 1 : 0;
  offsets.g92 = vector(kG92);
  offsets.g92_acts = value(kG92Acts) != 0.0;
  for (int i = 0; i < 2; ++i) {
    offsets.homes[i] = vector(kHome[i]);
    offsets.home_is_known[i] = true;
  }
  return offsets;
}

}  // namespace abbe::compensation
