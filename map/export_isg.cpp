#include <fmt/format.h>

#include <string>

#include "failure/failure.h"
#include "map/export_tables.h"
#include "map/text_file.h"
#include "map/words.h"
#include "settings/unit.h"

namespace abbe::map {
namespace {

using machine::kMotions;

using settings::kMillimetre;

int ColumnNamed(std::string_view name, const std::string& where) {
  const int error = ErrorNamed(name);
  if (error >= 0) return error;
  throw InputError(
      fmt::format("{}: \"{}\" is none of the 21 errors of three linear axes; take the column out",
                  where, name));
}

// The columns of a block: the index of the position, and the error in each other column.
struct Columns {
  int axis = -1;  // -1: a block of constants
  std::size_t position = 0;
  std::vector<int> errors;  // -1 for the position
};

Columns ColumnsOf(const std::vector<std::string_view>& names, const std::string& where) {
  Columns columns;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool is_axis = names[i] == "X" || names[i] == "Y" || names[i] == "Z";
    columns.errors.push_back(is_axis ? -1 : ColumnNamed(names[i], where));
    if (!is_axis) continue;
    if (columns.axis >= 0) {
      throw InputError(where +
                       ": errors that depend on two axes are not part of this machine model");
    }
    columns.axis = names[i][0] - 'X';
    columns.position = i;
  }
  for (const int error : columns.errors) {
    if (error < 0) continue;
    const bool is_constant = error >= kErrors - 3;
    if (is_constant != (columns.axis < 0) || (!is_constant && error / kMotions != columns.axis)) {
      throw InputError(
          fmt::format("{}: {} does not belong in this block; an axis has its own "
                      "block, the squareness one without position",
                      where, ErrorName(error)));
    }
  }
  return columns;
}

void TakeRow(const std::vector<double>& row, const Columns& columns, AxisTables& tables) {
  for (std::size_t i = 0; i < row.size(); ++i) {
    const int error = columns.errors[i];
    if (error < 0) continue;
    const double value = row[i] * TableUnit(error);
    if (error >= kErrors - 3) {
      tables.squareness[error - (kErrors - 3)] = value;
    } else {
      ErrorTable& table = tables.errors[error];
      table.positions.push_back(row[columns.position] * kMillimetre);
      table.values.push_back(value);
    }
  }
}

}  // namespace

Format::Paths WriteIsg(const ErrorMap& map, const ExportOptions& options,
                       const std::filesystem::path& path) {
  const AxisTables tables = Tabulate(map, options.tool, options.counts);
  std::string text = HeaderText(tables.header, "//", SignOfTables(tables));
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    const std::size_t first = kMotions * axis;
    text += "XYZ"[axis];
    for (int motion = 0; motion < kMotions; ++motion)
      text += fmt::format(" {}", machine::MotionName(axis, motion));
    text += '\n';
    for (std::size_t row = 0; row < tables.errors[first].positions.size(); ++row) {
      text += fmt::format("{}", tables.errors[first].positions[row] / kMillimetre);
      for (int motion = 0; motion < kMotions; ++motion) {
        const int error = kMotions * axis + motion;
        text += fmt::format(" {}", tables.errors[error].values[row] / TableUnit(error));
      }
      text += '\n';
    }
    text += "#\n";
  }
  text += fmt::format("C0Y B0Z A0Z\n{} {} {}\n", tables.squareness.z(), tables.squareness.y(),
                      tables.squareness.x());
  WriteWhole(text, path);
  return {path};
}

AxisTables ReadIsg(const std::filesystem::path& file) {
  const std::string text = ReadWhole(file);
  Lines lines(text, file.string());
  AxisTables tables;
  Columns columns;
  bool has_header = false;
  for (std::string_view line; lines.Next(line);) {
    const std::size_t mark = line.find("//");
    if (mark != std::string_view::npos) ReadComment(line.substr(mark + 2), tables.header);
    const auto words = WordsOf(line.substr(0, mark));
    if (words.empty()) continue;
    if (words[0].starts_with('#')) {
      has_header = false;
    } else if (!has_header) {
      columns = ColumnsOf(words, lines.Where());
      has_header = true;
    } else {
      const auto row = NumbersOf(line.substr(0, mark), lines.Where());
      if (row.size() != columns.errors.size()) {
        throw InputError(fmt::format("{}: {} numbers under {} names; each row has one for each",
                                     lines.Where(), row.size(), columns.errors.size()));
      }
      TakeRow(row, columns, tables);
    }
  }
  return tables;
}

ErrorField FieldOf(const AxisTables& tables) {
  const ErrorMap map = MapOfTables(tables);
  return [map, tool = tables.header.tool](const Eigen::Vector3d& p) { return map.Error(p, tool); };
}

ErrorField ReadBackIsg(const Format::Paths& files, const machine::Chain& /*chain*/) {
  return FieldOf(ReadIsg(files.front()));
}

}  // namespace abbe::map
