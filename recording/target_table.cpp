#include "recording/target_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "recording/target_test.h"
#include "settings/toml_text.h"
#include "settings/unit.h"
#include "settings/words.h"

namespace abbe::recording {
namespace {

struct TargetTable {
  std::string file;
  double mm_per_unit = 1.0;
  bool has_unit = false;
  int cycles = 0;     // 0: not stated
  int positions = 0;  // 0: not stated
  std::string target_source, reference_source;
  std::map<int, double> targets;
  std::map<TargetPlace, double> forward, backward;
  std::vector<std::string> warnings;
};

// One line "NAME[i,j] = value".
class Assignment {
 public:
  Assignment(const std::string& file, int line, std::string_view text)
      : at_(fmt::format("{}:{}", file, line)) {
    const auto equals = text.find('=');
    if (equals == std::string_view::npos) {
      throw InputError(
          fmt::format("{}: \"{}\" is not NAME=value; write comments after #", at_, text));
    }
    value_ = settings::Trimmed(text.substr(equals + 1));
    std::string_view left = settings::Trimmed(text.substr(0, equals));
    const auto bracket = left.find('[');
    name_ = left.substr(0, bracket);
    if (bracket == std::string_view::npos) return;
    if (left.back() != ']') Refuse("has no closing ]");
    left = left.substr(bracket + 1, left.size() - bracket - 2);
    for (auto comma = left.find(','); comma != std::string_view::npos; comma = left.find(',')) {
      indices_.push_back(Parse<int>(settings::Trimmed(left.substr(0, comma))));
      left.remove_prefix(comma + 1);
    }
    indices_.push_back(Parse<int>(settings::Trimmed(left)));
  }

  const std::string& name() const { return name_; }
  const std::string& value() const { return value_; }
  int Whole() const { return Index(Parse<int>(value_)); }
  double Number() const { return Parse<double>(value_); }

  int Position() const {
    if (indices_.size() != 1) Refuse("needs one index, the position");
    return Index(indices_[0]);
  }
  TargetPlace PositionAndCycle() const {
    if (indices_.size() != 2) Refuse("needs two indices, position and cycle");
    return {Index(indices_[0]), Index(indices_[1])};
  }

  [[noreturn]] void Refuse(std::string_view why) const {
    throw InputError(fmt::format("{}: {} {}", at_, name_, why));
  }

 private:
  template <typename T>
  T Parse(std::string_view text) const {
    T value{};
    if (text.starts_with('+')) text.remove_prefix(1);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() ||
        !std::isfinite(static_cast<double>(value))) {
      Refuse(fmt::format("holds \"{}\" where a number is expected", text));
    }
    return value;
  }
  int Index(int index) const {
    if (index < 1) Refuse(fmt::format("holds {}: count from 1", index));
    return index;
  }

  std::string at_, name_, value_;
  std::vector<int> indices_;
};

double MillimetresPerUnit(const Assignment& unit) {
  if (unit.value() == "mm") return 1.0;
  if (unit.value() == "m") return 1.0 / settings::kMillimetre;
  if (unit.value() == "um") return settings::kMicrometre / settings::kMillimetre;
  if (unit.value() == "deg" || unit.value() == "rad") {
    unit.Refuse(fmt::format(
        "is \"{}\": positions of a rotary axis are no lengths; only X, Y and Z can be measured",
        unit.value()));
  }
  unit.Refuse(fmt::format("is \"{}\": give m, mm or um", unit.value()));
}

void Take(const Assignment& line, TargetTable& table) {
  const auto once = [&line](bool is_new) {
    if (!is_new) line.Refuse("is given twice with these indices: keep one");
  };
  if (line.name() == "TGT_DATA") {
    once(table.targets.emplace(line.Position(), line.Number()).second);
  } else if (line.name() == "REF_DATA_FWD") {
    once(table.forward.emplace(line.PositionAndCycle(), line.Number()).second);
  } else if (line.name() == "REF_DATA_BWD") {
    once(table.backward.emplace(line.PositionAndCycle(), line.Number()).second);
  } else if (line.name() == "UNIT") {
    table.mm_per_unit = MillimetresPerUnit(line);
    table.has_unit = true;
  } else if (line.name() == "CYCLES") {
    table.cycles = line.Whole();
  } else if (line.name() == "POSITIONS") {
    table.positions = line.Whole();
  } else if (line.name() == "TGT_SET_PV") {
    table.target_source = line.value();
  } else if (line.name() == "REF_PV") {
    table.reference_source = line.value();
  } else if (line.name() != "TEST_PV" && line.name() != "DEC") {
    table.warnings.push_back(fmt::format("{}: {} is not used", table.file, line.name()));
  }
}

TargetTable ReadTable(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path)) {
    throw InputError(fmt::format("{}: cannot be read: check the path", path.string()));
  }
  TargetTable table;
  table.file = path.string();
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    std::string_view text = settings::Trimmed(line);
    constexpr std::string_view kPrefix = "TEST_DATA=";
    if (number == 1 && text.starts_with(kPrefix))
      text = settings::Trimmed(text.substr(kPrefix.size()));
    if (text.empty() || text.starts_with('#')) continue;
    Take(Assignment(table.file, number, text), table);
  }
  if (!table.has_unit) {
    table.warnings.push_back(fmt::format(
        "{}: has no UNIT: its numbers are taken as mm; add UNIT=mm, m or um", table.file));
  }
  return table;
}

// Completes the numbers that the file does not state and refuses contradictions.
void Complete(TargetTable& table) {
  const int targets = table.targets.empty() ? 0 : table.targets.rbegin()->first;
  if (table.positions == 0) table.positions = targets;
  int cycles = 0;
  for (const auto* readings : {&table.forward, &table.backward}) {
    for (const auto& [place, value] : *readings) {
      cycles = std::max(cycles, place.cycle);
      if (place.position > table.positions) {
        throw InputError(
            fmt::format("{}: a reading at position {}, but there are {}: correct POSITIONS or "
                        "add TGT_DATA[{}]",
                        table.file, place.position, table.positions, place.position));
      }
    }
  }
  if (cycles == 0) {
    throw InputError(fmt::format(
        "{}: no REF_DATA_FWD or REF_DATA_BWD: not a target and cycle table", table.file));
  }
  if (table.cycles == 0) table.cycles = cycles;
  if (cycles > table.cycles) {
    throw InputError(fmt::format("{}: a reading of cycle {}, but CYCLES={}: correct one of them",
                                 table.file, cycles, table.cycles));
  }
  for (int position = 1; position <= std::max(table.positions, targets); ++position) {
    if (!table.targets.contains(position) || position > table.positions) {
      throw InputError(fmt::format(
          "{}: {} positions, but TGT_DATA[{}] is {}: correct POSITIONS or the targets", table.file,
          table.positions, position, table.targets.contains(position) ? "given" : "missing"));
    }
  }
}

std::string Sources(const TargetTable& table, const std::string& axis) {
  if (table.target_source.empty() && table.reference_source.empty()) return "";
  const char small = static_cast<char>(axis[0] - 'A' + 'a');
  std::string header = "[sources]\n";
  if (!table.target_source.empty()) {
    header += fmt::format("{}_mm = {}\n", small, settings::Quoted(table.target_source));
  }
  if (!table.reference_source.empty()) {
    header += fmt::format("ref_{}_mm = {}\n", small, settings::Quoted(table.reference_source));
  }
  return header;
}

}  // namespace

Recording ReadTargetTable(const std::filesystem::path& path, const std::string& axis) {
  MustBeLinear(path.string(), axis);
  TargetTable table = ReadTable(path);
  Complete(table);
  TargetTest test{table.file,
                  axis,
                  std::move(table.targets),
                  std::move(table.forward),
                  std::move(table.backward),
                  table.cycles,
                  table.mm_per_unit};
  test.more_header = Sources(table, axis);
  test.target_name = "TGT_DATA";
  test.forward_name = "REF_DATA_FWD";
  test.backward_name = "REF_DATA_BWD";
  test.warnings = std::move(table.warnings);
  return RecordingOf(std::move(test));
}

}  // namespace abbe::recording
