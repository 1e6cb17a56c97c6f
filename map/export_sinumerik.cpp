#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>
#include <string>

#include "failure/failure.h"
#include "map/export_axis_comp.h"
#include "map/text_file.h"
#include "map/words.h"
#include "settings/unit.h"

namespace abbe::map {
namespace {

using settings::kMillimetre;
constexpr int kTables = 9;
const std::vector<std::string> kSignOfCec = {
    "a correction: the control adds it to the position of the output axis, in mm as it counts that "
    "axis",
    "it is minus the error: commanded minus actual position of the tool in the workpiece, in the "
    "numbers of the axis"};

// One CEC table as in its file, mm.
struct CecTable {
  std::map<int, double> values;
  std::map<std::string, double, std::less<>> numbers;  // STEP, MIN, MAX ...
  int input = -1, output = -1;
};

std::string TableText(int table, const GridAxis& stations, const std::vector<double>& values) {
  std::string text;
  for (std::size_t n = 0; n < values.size(); ++n) {
    text += fmt::format("$AN_CEC[{},{}]={:.9f}\n", table, n, values[n] / kMillimetre);
  }
  const auto set = [&](std::string_view what, const std::string& value) {
    text += fmt::format("$AN_CEC_{}[{}]={}\n", what, table, value);
  };
  set("INPUT_AXIS", fmt::format("(AX{})", table / 3 + 1));
  set("OUTPUT_AXIS", fmt::format("(AX{})", table % 3 + 1));
  set("STEP", fmt::format("{}", stations.Step() / kMillimetre));
  set("MIN", fmt::format("{}", stations.first / kMillimetre));
  set("MAX", fmt::format("{}", stations.last / kMillimetre));
  for (const char* const none : {"DIRECTION", "MULT_BY_TABLE", "IS_MODULO"}) set(none, "0");
  return text;
}

int AxisOf(std::string_view value, const std::string& where) {
  if (value == "(AX1)" || value == "(AX2)" || value == "(AX3)") return value[3] - '1';
  throw InputError(fmt::format("{}: {} is not an axis; write (AX1), (AX2) or (AX3)", where, value));
}

int IndexOf(std::string_view word, int size, const std::string& where) {
  const double index = NumberOf(word, where);
  if (index != std::floor(index) || index < 0 || index >= size) {
    throw InputError(fmt::format("{}: the index {} is not one of 0 to {}", where, word, size - 1));
  }
  return static_cast<int>(index);
}

void TakeLine(std::string_view line, const std::string& where,
              std::array<CecTable, kTables>& tables) {
  const auto equals = line.find('='), open = line.find('['), close = line.find(']');
  if (!line.starts_with("$AN_CEC") || close == std::string_view::npos || open > close ||
      equals == std::string_view::npos || close > equals) {
    throw InputError(
        fmt::format("{}: expected $AN_CEC[table,point]=value or a key of a table", where));
  }
  constexpr int kMaxPoints = 10000;
  const auto index = PartsOf(line.substr(open + 1, close - open - 1), ',');
  const std::string_view value = Trimmed(line.substr(equals + 1));
  const std::string_view key = Trimmed(line.substr(7, open - 7));
  CecTable& table = tables[IndexOf(index[0], kTables, where)];
  if (key.empty()) {
    if (index.size() != 2) throw InputError(where + ": expected $AN_CEC[table,point]");
    table.values[IndexOf(index[1], kMaxPoints, where)] = NumberOf(value, where);
  } else if (key == "_INPUT_AXIS") {
    table.input = AxisOf(value, where);
  } else if (key == "_OUTPUT_AXIS") {
    table.output = AxisOf(value, where);
  } else {
    table.numbers[std::string(key.substr(1))] = NumberOf(value, where);
  }
}

AxisCurve CurveOf(const CecTable& table, int number, const std::string& file) {
  const auto refused = [&](std::string_view what) {
    return InputError(fmt::format("{}: table {} {}", file, number, what));
  };
  for (const char* const key : {"STEP", "MIN", "MAX", "DIRECTION", "MULT_BY_TABLE", "IS_MODULO"}) {
    if (!table.numbers.contains(key)) throw refused(fmt::format("lacks $AN_CEC_{}", key));
  }
  for (const char* const key : {"DIRECTION", "MULT_BY_TABLE", "IS_MODULO"}) {
    if (table.numbers.at(key) != 0.0) throw refused(fmt::format("has a {} other than 0", key));
  }
  if (table.input < 0 || table.output < 0) throw refused("lacks its axes");
  const double step = table.numbers.at("STEP"), first = table.numbers.at("MIN");
  const double points = (table.numbers.at("MAX") - first) / step + 1;
  if (!(step > 0.0) || std::lround(points) != std::ssize(table.values) || table.values.size() < 2 ||
      table.values.rbegin()->first + 1 != std::ssize(table.values)) {
    throw refused(fmt::format("has {} values where MIN, MAX and STEP make {:.6g} points",
                              table.values.size(), points));
  }
  AxisCurve curve;
  for (const auto& [n, value] : table.values) {
    curve.positions.push_back((first + n * step) * kMillimetre);
    curve.values.push_back(value * kMillimetre);
  }
  return curve;
}

}  // namespace

Format::Paths WriteSinumerik(const ErrorMap& map, const ExportOptions& options,
                             const std::filesystem::path& path) {
  const Eigen::Vector3d signs = map.model().chain().ToolSenses();
  const auto& travels = map.model().travels();
  Eigen::Vector3d middle;
  for (int k = 0; k < 3; ++k) {
    middle[k] = (travels[k].first + travels[k].last) / 2;
  }
  const Eigen::Vector3d at_middle = map.Error(middle, options.tool);
  std::string text = "%_N_NC_CEC_INI\n" + HeaderText(HeaderOf(map, options.tool), ";", kSignOfCec) +
                     "CHANDATA(1)\n";
  for (int table = 0; table < kTables; ++table) {
    const int input = table / 3, output = table % 3;
    if (options.counts[input] < 2) throw InputError("a CEC table takes at least two points");
    const GridAxis stations{travels[input].first, travels[input].last, options.counts[input]};
    std::vector<double> values;
    for (Eigen::Index i = 0; i < stations.count; ++i) {
      Eigen::Vector3d position = middle;
      position[input] = stations.At(i);
      double error = map.Error(position, options.tool)[output];
      // The three tables of an output axis are added: only one contains the error in the middle.
      if (input != output) error -= at_middle[output];
      values.push_back(-signs[output] * error);
    }
    text += TableText(table, stations, values);
  }
  WriteWhole(text + "M17\n", path);
  return {path};
}

ErrorField ReadBackSinumerik(const Format::Paths& files, const machine::Chain& chain) {
  const std::string text = ReadWhole(files.front());
  Lines lines(text, files.front().string());
  std::array<CecTable, kTables> tables;
  bool has_end = false;
  for (std::string_view line; lines.Next(line);) {
    const std::string_view content = Trimmed(line.substr(0, line.find(';')));
    has_end = has_end || content == "M17";
    if (content.empty() || content == "M17" || content[0] == '%' || content == "CHANDATA(1)")
      continue;
    TakeLine(content, lines.Where(), tables);
  }
  if (!has_end) throw InputError(files.front().string() + ": ends without M17; it is cut off");
  struct Relation {
    int input, output;
    AxisCurve curve;
  };
  std::vector<Relation> relations;
  for (int t = 0; t < kTables; ++t) {
    const CecTable& table = tables[t];
    relations.push_back({table.input, table.output, CurveOf(table, t, files.front().string())});
  }
  const Eigen::Vector3d signs = chain.ToolSenses();
  return [relations, signs](const Eigen::Vector3d& p) {
    Eigen::Vector3d correction = Eigen::Vector3d::Zero();
    for (const Relation& relation : relations) {
      correction[relation.output] += relation.curve.At(p[relation.input]);
    }
    return Eigen::Vector3d(-signs.cwiseProduct(correction));
  };
}

}  // namespace abbe::map
