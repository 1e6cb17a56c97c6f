#include <fmt/format.h>

#include <array>
#include <bitset>
#include <string>

#include "failure/failure.h"
#include "map/export_tables.h"
#include "map/text_file.h"
#include "map/words.h"
#include "settings/unit.h"

namespace abbe::map {
namespace {

using settings::kMillimetre;
constexpr int kFunctions = kErrors - 3;

class EtalonReader {
 public:
  explicit EtalonReader(const std::filesystem::path& file)
      : text_(ReadWhole(file)), lines_(text_, file.string()) {}

  AxisTables Read() {
    for (std::string_view line; lines_.Next(line);) {
      const std::size_t mark = line.find("//");
      if (mark != std::string_view::npos) ReadComment(line.substr(mark + 2), tables_.header);
      const std::string_view content = Trimmed(line.substr(0, mark));
      if (!content.empty()) Take(content);
    }
    if (in_points_) throw Refused("the file ends within Gridpoints; it is cut off");
    return tables_;
  }

 private:
  InputError Refused(std::string_view what) const {
    return InputError(fmt::format("{}: {}", lines_.Where(), what));
  }

  void Take(std::string_view content) {
    if (in_points_) {
      if (content == "}") {
        in_points_ = false;
      } else {
        TakePoint(content);
      }
    } else if (content.starts_with('[') && content.ends_with(']')) {
      error_ = SectionNamed(content.substr(1, content.size() - 2));
      if (seen_.test(error_)) {
        throw Refused(ErrorName(error_) + " is given twice");
      }
      seen_.set(error_);
    } else {
      TakeAssignment(content);
    }
  }

  int SectionNamed(std::string_view name) const {
    const int error = ErrorNamed(name);
    if (error >= 0) return error;
    throw Refused(fmt::format(
        "[{}] is none of the 21 errors of three linear axes; take the section out", name));
  }

  void TakeAssignment(std::string_view content) {
    const auto parts = PartsOf(content, '=');
    const bool is_constant = error_ >= kFunctions;
    if (error_ < 0 || parts.size() != 2) throw Refused("expected a section like [EXX]");
    if (parts[0] == "VALUE" && is_constant) {
      tables_.squareness[error_ - kFunctions] = NumberOf(parts[1], lines_.Where());
    } else if (parts[0] == "Gridpoints" && parts[1] == "{" && !is_constant) {
      in_points_ = true;
    } else {
      throw Refused(fmt::format("expected {}", is_constant ? "VALUE = number" : "Gridpoints = {"));
    }
  }

  void TakePoint(std::string_view content) {
    const auto numbers = NumbersOf(content, lines_.Where());
    if (numbers.size() != 2) throw Refused("expected a position and a value");
    ErrorTable& table = tables_.errors[error_];
    if (!table.positions.empty() && !(numbers[0] * kMillimetre > table.positions.back())) {
      throw Refused("the position is not above the one before it");
    }
    table.positions.push_back(numbers[0] * kMillimetre);
    table.values.push_back(numbers[1] * TableUnit(error_));
  }

  std::string text_;
  Lines lines_;
  AxisTables tables_;
  std::bitset<kErrors> seen_;
  int error_ = -1;
  bool in_points_ = false;
};

}  // namespace

Format::Paths WriteEtalon(const ErrorMap& map, const ExportOptions& options,
                          const std::filesystem::path& path) {
  const AxisTables tables = Tabulate(map, options.tool, options.counts);
  std::string text = HeaderText(tables.header, "//", SignOfTables(tables));
  for (int error = 0; error < kFunctions; ++error) {
    const ErrorTable& table = tables.errors[error];
    text += fmt::format("[{}]\nGridpoints = {{\n", ErrorName(error));
    for (std::size_t i = 0; i < table.positions.size(); ++i) {
      text += fmt::format("{} {}\n", table.positions[i] / kMillimetre,
                          table.values[i] / TableUnit(error));
    }
    text += "}\n";
  }
  for (int k = 0; k < 3; ++k) {
    text += fmt::format("[{}]\nVALUE = {}\n", ErrorName(kFunctions + k), tables.squareness[k]);
  }
  WriteWhole(text, path);
  return {path};
}

AxisTables ReadEtalon(const std::filesystem::path& file) { return EtalonReader(file).Read(); }

ErrorField ReadBackEtalon(const Format::Paths& files, const machine::Chain& /*chain*/) {
  return FieldOf(ReadEtalon(files.front()));
}

}  // namespace abbe::map
