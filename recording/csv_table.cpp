#include "recording/csv_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <string_view>

#include "recording/column_sum.h"
#include "recording/csv_form.h"
#include "recording/line_reader.h"
#include "settings/table_cells.h"
#include "settings/toml_text.h"
#include "settings/words.h"

namespace abbe::recording {
namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

std::vector<std::string> CellsOf(std::string_view line, char separator) {
  std::vector<std::string> cells;
  for (const std::string_view cell : settings::CellsOf(line, separator)) {
    cells.push_back(settings::Unquoted(cell));
  }
  return cells;
}

double NumberIn(std::string_view written, char separator) {
  const std::string cell = settings::WithDecimalPoint(written, separator);
  double value = kNoNumber;
  const char* const end = cell.data() + cell.size();
  const char* const begin = cell.starts_with('+') ? cell.data() + 1 : cell.data();
  const auto [stop, error] = std::from_chars(begin, end, value);
  return error == std::errc{} && stop == end && std::isfinite(value) ? value : kNoNumber;
}

class TableReader {
 public:
  TableReader(const std::filesystem::path& path, const CsvTableOptions& options)
      : path_(path.string()), options_(options), lines_(path) {
    recording_.name = path_;
    if (options.columns.empty()) {
      for (const std::string& name : options.names) {
        if (name != "-") columns_.push_back({name, name});
      }
    } else {
      columns_ = options.columns;
    }
    for (MonitoredColumn& column : columns_) {
      if (column.name == "order") {
        column.name = "time_s";
        counts_ = true;
      }
      if (column.name == "time_s") has_time_ = true;
    }
    counts_ = counts_ || (!has_time_ && !options.shuffled);
    if (has_time_ && options.shuffled) {
      throw InputError(path_ +
                       ": time_s or order says when its rows were measured; leave one of "
                       "them and --shuffled out");
    }
  }

  Recording Read() {
    std::optional<std::string_view> line = Next();
    separator_ = line ? settings::SeparatorOf(*line) : ',';
    if (options_.names.empty()) {
      names_ = line ? CellsOf(*line, separator_) : std::vector<std::string>{};
      line = std::nullopt;
    } else {
      names_ = options_.names;
    }
    Choose();
    double order = 0.0;
    if (!line) line = Next();
    for (; line; line = Next(), ++order) Take(CellsOf(*line, separator_), order);
    if (recording_.rows() == 0) {
      throw InputError(fmt::format("{}: no row is left; correct --where or the table", path_));
    }
    if (!any_good_) {
      throw InputError(fmt::format(
          "{}: no row has a number in every requested column; is {} the separator of the table?",
          path_, separator_ == '\t' ? "a tab" : fmt::format("\"{}\"", separator_)));
    }
    recording_.header = Header();
    if (has_time_) SortByTime();
    return std::move(recording_);
  }

 private:
  void SortByTime() {
    const std::vector<double> time(recording_.At("time_s").begin(), recording_.At("time_s").end());
    std::vector<std::size_t> rows(time.size());
    std::iota(rows.begin(), rows.end(), std::size_t{0});
    std::stable_sort(rows.begin(), rows.end(), [&](std::size_t a, std::size_t b) {
      return std::isnan(time[b]) ? !std::isnan(time[a]) : time[a] < time[b];
    });
    for (auto& column : recording_.columns) {
      const std::vector<double> values = column.values;
      for (std::size_t i = 0; i < rows.size(); ++i) column.values[i] = values[rows[i]];
    }
  }

  void Choose() {
    if (columns_.empty()) {
      throw InputError(fmt::format(
          "{}: the table does not state its quantities and units ({}); name the columns with "
          "their units, for example --column pivot_1_rad=NAME",
          path_, fmt::join(names_, ", ")));
    }
    for (const MonitoredColumn& column : columns_) {
      sums_.push_back(ParseColumnSum(column.channel, column.name, names_, path_));
      for (std::string& note : sums_.back().notes) recording_.warnings.push_back(std::move(note));
    }
    for (const auto& [column, wanted] : options_.where) {
      asked_.push_back(ParseColumnSum(column, column, names_, path_).terms.front().column);
    }
    if (!has_time_ && counts_) recording_.columns.push_back({"time_s", {}});
    for (const auto& column : columns_) recording_.columns.push_back({column.name, {}});
    recording_.columns.push_back({"flags", {}});
  }

  std::optional<std::string_view> Next() {
    for (auto line = lines_.Next(); line; line = lines_.Next()) {
      if (line->find('\0') != std::string_view::npos) {
        throw InputError(fmt::format("{}:{}: is not UTF-8 text; save the table as CSV (UTF-8)",
                                     path_, lines_.number()));
      }
      const std::string_view text = settings::Trimmed(*line);
      if (!text.empty() && !text.starts_with('#')) return line;
    }
    return std::nullopt;
  }

  bool Says(const std::string& cell, const std::string& wanted) const {
    return cell == wanted || NumberIn(cell, separator_) == NumberIn(wanted, ',');  // false for NaN
  }

  void Take(const std::vector<std::string>& cells, double order) {
    if (cells.size() != names_.size()) {
      throw InputError(
          fmt::format("{}:{}: {} cells, but the table has {} columns{}", path_, lines_.number(),
                      cells.size(), names_.size(),
                      separator_ == ',' && cells.size() > names_.size()
                          ? "; does it have decimal commas? then separate its cells by ;"
                          : ""));
    }
    for (std::size_t i = 0; i < asked_.size(); ++i) {
      if (!Says(cells[asked_[i]], options_.where[i].second)) return;
    }
    numbers_.clear();
    for (const std::string& cell : cells) numbers_.push_back(NumberIn(cell, separator_));
    auto column = recording_.columns.begin();
    if (!has_time_ && counts_) (column++)->values.push_back(order);
    bool good = true;
    for (const ColumnSum& sum : sums_) {
      const double value = sum.Of(numbers_);
      good = good && std::isfinite(value);
      (column++)->values.push_back(value);
    }
    any_good_ = any_good_ || good;
    column->values.push_back(good ? 0.0 : static_cast<double>(kDeviceError));
  }

  std::string Header() const {
    std::string header = fmt::format("kind = {}\n", settings::Quoted(options_.kind));
    if (counts_) header += "time = \"order\"\n";
    header += fmt::format("imported_from = {}\n[sources]\n",
                          settings::Quoted(std::filesystem::path(path_).filename().string()));
    for (const MonitoredColumn& column : columns_) {
      header +=
          fmt::format("{} = {}\n", settings::Key(column.name), settings::Quoted(column.channel));
    }
    return header;
  }

  std::string path_;
  const CsvTableOptions& options_;
  LineReader lines_;
  char separator_ = ',';
  std::vector<std::string> names_;
  std::vector<MonitoredColumn> columns_;
  std::vector<ColumnSum> sums_;
  std::vector<std::size_t> asked_;
  std::vector<double> numbers_;  // of the current row
  bool has_time_ = false, any_good_ = false;
  bool counts_ = false;  // time_s is an index
  Recording recording_;
};

}  // namespace

bool IsCsvTable(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  if (extension != ".csv" && extension != ".CSV") return false;
  LineReader lines(path);
  const auto first = lines.Next();
  return first && first->find('#') == std::string_view::npos;
}

Recording ReadCsvTable(const std::filesystem::path& path, const CsvTableOptions& options) {
  return TableReader(path, options).Read();
}

}  // namespace abbe::recording
