#include "recording/csv_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include "recording/line_reader.h"
#include "settings/toml_text.h"
#include "settings/unit.h"

namespace abbe::recording {
namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

std::string_view TrimmedCell(std::string_view text) {
  constexpr std::string_view kCellEdges = " \t\"";
  const auto first = text.find_first_not_of(kCellEdges);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kCellEdges) - first + 1);
}

std::vector<std::string> CellsOf(std::string_view line) {
  std::vector<std::string> cells;
  for (;;) {
    const auto comma = line.find(',');
    cells.emplace_back(TrimmedCell(line.substr(0, comma)));
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
  }
}

double NumberIn(const std::string& cell) {
  double value = kNoNumber;
  const char* const end = cell.data() + cell.size();
  const auto [stop, error] = std::from_chars(cell.data(), end, value);
  return error == std::errc{} && stop == end && std::isfinite(value) ? value : kNoNumber;
}

bool Says(const std::string& cell, const std::string& wanted) {
  return cell == wanted || NumberIn(cell) == NumberIn(wanted);  // false for NaN
}

class TableReader {
 public:
  TableReader(const std::filesystem::path& path, const CsvTableOptions& options)
      : path_(path.string()), options_(options), lines_(path) {
    if (options.columns.empty()) {
      throw InputError(fmt::format(
          "{}: a table does not say what its columns are; name them with their units, for example "
          "pivot_1_rad=NAME",
          path_));
    }
    recording_.name = path_;
    for (const MonitoredColumn& column : options.columns) {
      if (column.name == "time_s") has_time_ = true;
    }
  }

  Recording Read() {
    std::optional<std::string_view> line = Next();
    names_ = line ? CellsOf(*line) : std::vector<std::string>{};
    for (const MonitoredColumn& column : options_.columns) {
      from_.push_back(Find(column.channel));
      const auto was = settings::UnitOf(column.channel), is = settings::UnitOf(column.name);
      factor_.push_back(was.name.empty() ? 1.0 : was.si / is.si);
    }
    for (const auto& [column, wanted] : options_.where) asked_.push_back(Find(column));
    if (!has_time_) recording_.columns.push_back({"time_s", {}});
    for (const auto& column : options_.columns) recording_.columns.push_back({column.name, {}});
    recording_.columns.push_back({"flags", {}});
    double order = 0.0;
    for (line = Next(); line; line = Next(), ++order) Take(CellsOf(*line), order);
    if (recording_.rows() == 0) {
      throw InputError(fmt::format("{}: no row is left; correct --where or the table", path_));
    }
    recording_.header = Header();
    return std::move(recording_);
  }

 private:
  std::optional<std::string_view> Next() {
    for (auto line = lines_.Next(); line; line = lines_.Next()) {
      const std::string_view text = TrimmedCell(*line);
      if (!text.empty() && !text.starts_with('#')) return line;
    }
    return std::nullopt;
  }

  std::size_t Find(const std::string& name) const {
    const auto found = std::find(names_.begin(), names_.end(), name);
    if (found != names_.end()) return static_cast<std::size_t>(found - names_.begin());
    throw InputError(
        fmt::format("{}: has no column \"{}\"; it has {}", path_, name, fmt::join(names_, ", ")));
  }

  void Take(const std::vector<std::string>& cells, double order) {
    if (cells.size() != names_.size()) {
      throw InputError(fmt::format("{}:{}: {} cells, but the table has {} columns", path_,
                                   lines_.number(), cells.size(), names_.size()));
    }
    for (std::size_t i = 0; i < asked_.size(); ++i) {
      if (!Says(cells[asked_[i]], options_.where[i].second)) return;
    }
    auto column = recording_.columns.begin();
    if (!has_time_) (column++)->values.push_back(order);
    bool good = true;
    for (std::size_t i = 0; i < from_.size(); ++i) {
      const double value = factor_[i] * NumberIn(cells[from_[i]]);
      good = good && std::isfinite(value);
      (column++)->values.push_back(value);
    }
    column->values.push_back(good ? 0.0 : static_cast<double>(kDeviceError));
  }

  std::string Header() const {
    std::string header = fmt::format("kind = {}\n", settings::Quoted(options_.kind));
    if (!has_time_) header += "time = \"order\"\n";
    header += fmt::format("imported_from = {}\n[sources]\n",
                          settings::Quoted(std::filesystem::path(path_).filename().string()));
    for (const MonitoredColumn& column : options_.columns) {
      header += fmt::format("{} = {}\n", column.name, settings::Quoted(column.channel));
    }
    return header;
  }

  std::string path_;
  const CsvTableOptions& options_;
  LineReader lines_;
  std::vector<std::string> names_;
  std::vector<std::size_t> from_, asked_;
  std::vector<double> factor_;
  bool has_time_ = false;
  Recording recording_;
};

}  // namespace

bool IsCsvTable(const std::filesystem::path& path) {
  if (path.extension() != ".csv") return false;
  LineReader lines(path);
  const auto first = lines.Next();
  return first && first->find('#') == std::string_view::npos;
}

Recording ReadCsvTable(const std::filesystem::path& path, const CsvTableOptions& options) {
  return TableReader(path, options).Read();
}

}  // namespace abbe::recording
