#include "recording/csv_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <string_view>

#include "recording/check.h"
#include "recording/csv_form.h"
#include "recording/line_reader.h"
#include "recording/recording_file.h"

namespace abbe::recording {
namespace {

constexpr std::string_view kBlanks = " \t";

std::string_view Trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

InputError Error(const Places& places, std::size_t line, std::string_view message) {
  return InputError(fmt::format("{}:{}: {}", places.file, line, message));
}

// "abbe-recording = 1", with any blanks.
void CheckSignature(std::string_view line, const Places& places) {
  std::string packed;
  for (const char c : line) {
    if (kBlanks.find(c) == std::string_view::npos) packed += c;
  }
  const std::string_view key = "#abbe-recording=";
  if (!packed.starts_with(key) || packed == key) {
    const bool binary =
        std::any_of(line.begin(), line.end(), [](char c) { return c >= 0 && c < 9; });
    throw Error(places, 1,
                binary ? std::string("this is a binary file, not a CSV recording; check the path")
                       : fmt::format("is not a recording: its first line must be `{}`; a table of "
                                     "another program becomes one by abbe convert",
                                     kSignature));
  }
  if (packed.substr(key.size()) != "1") {
    throw Error(
        places, 1,
        fmt::format("is a recording of version {}; this abbe reads version 1, use a newer one",
                    packed.substr(key.size())));
  }
}

std::vector<std::string> ColumnNames(std::string_view line, const std::string& place) {
  for (const char separator : {';', '\t'}) {
    if (line.find(',') == std::string_view::npos &&
        line.find(separator) != std::string_view::npos) {
      throw InputError(fmt::format(
          "{}: fields are separated by {}; export with commas between fields and points in numbers",
          place, separator == ';' ? "semicolons" : "tabs"));
    }
  }
  std::vector<std::string> names;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    names.emplace_back(Trimmed(line.substr(begin, end - begin)));
    begin = end + 1;
  }
  CheckColumnNames(names, place);
  return names;
}

// Parses rows into the columns of a recording.
class RowParser {
 public:
  RowParser(Recording& recording, const Places& places)
      : columns_(recording.columns), places_(places) {}

  void Parse(std::string_view line, std::size_t number) const {
    const char* at = line.data();
    const char* const end = at + line.size();
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      at = SkipBlanks(at, end);
      double value = std::numeric_limits<double>::quiet_NaN();
      if (at != end && *at != ',') {
        const char* const begin = *at == '+' && at + 1 != end && at[1] != '-' ? at + 1 : at;
        const auto [stop, error] = std::from_chars(begin, end, value);
        at = SkipBlanks(stop, end);
        if (error != std::errc{} || (at != end && *at != ',')) RefuseField(line, number, c);
      }
      const bool last = c + 1 == columns_.size();
      if (last != (at == end)) RefuseRagged(line, number);
      columns_[c].values.push_back(value);
      ++at;
    }
  }

 private:
  static const char* SkipBlanks(const char* at, const char* end) {
    while (at != end && (*at == ' ' || *at == '\t')) ++at;
    return at;
  }

  [[noreturn]] void RefuseRagged(std::string_view line, std::size_t number) const {
    const auto fields = static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) + 1;
    throw Error(
        places_, number,
        fmt::format("has {} fields, but there are {} columns{}", fields, columns_.size(),
                    fields > columns_.size() ? "; does it have decimal commas? write 1.5, not 1,5"
                                             : "; complete the row or remove it"));
  }

  [[noreturn]] void RefuseField(std::string_view line, std::size_t number,
                                std::size_t column) const {
    const auto fields = static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) + 1;
    if (fields != columns_.size()) RefuseRagged(line, number);
    for (std::size_t c = 0; c < column; ++c) line.remove_prefix(line.find(',') + 1);
    const std::string_view field = Trimmed(line.substr(0, line.find(','))).substr(0, 40);
    throw Error(places_, number,
                fmt::format("{}: `{}` is not a number that fits a double; write a number, or leave "
                            "the field empty and set a flag",
                            columns_[column].name, field));
  }

  std::vector<Column>& columns_;
  const Places& places_;
};

// The recording without rows; the next line of `lines` is the first row.
Recording ReadHead(LineReader& lines, Places& places) {
  Recording recording;
  recording.name = places.file;
  CheckSignature(lines.Next().value_or(std::string_view{}), places);
  places.header_line = 2;
  std::optional<std::string_view> line;
  while ((line = lines.Next()) && lines.complete() && line->starts_with('#')) {
    line->remove_prefix(line->starts_with("# ") ? 2 : 1);
    recording.header.append(*line).append("\n");
  }
  if (!line || !lines.complete()) {
    throw Error(places, lines.number(), "the file ends before its first row; nothing was recorded");
  }
  places.first_row_line = lines.number() + 1;
  const std::vector<std::string> names =
      ColumnNames(*line, fmt::format("{}:{}", places.file, lines.number()));
  CheckHeader(recording.header, names, places);
  for (const std::string& name : names) recording.columns.push_back({name, {}});
  return recording;
}

}  // namespace

void ReadCsv(const std::filesystem::path& path, std::size_t rows,
             const std::function<void(Recording& block)>& use) {
  LineReader lines(path);
  Places places{path.string()};
  Recording block = ReadHead(lines, places);
  RowCheck check(places);
  const std::size_t at_most = rows <= kBlockRows ? rows : lines.CountLineEnds();
  for (Column& column : block.columns) column.values.reserve(at_most);
  const RowParser parser(block, places);
  std::size_t blank = 0, before = 0;  // a blank line; rows of earlier blocks
  while (const auto line = lines.Next()) {
    if (!lines.complete()) {
      block.warnings.push_back(
          fmt::format("{}:{}: the last line has no line end, as if cut: that row is dropped",
                      places.file, lines.number()));
    } else if (Trimmed(*line).empty()) {
      if (blank == 0) blank = lines.number();
    } else if (blank != 0) {
      throw Error(places, blank, "is blank, and rows follow; remove the line");
    } else {
      if (block.rows() == rows) {
        check.Take(block);
        before += rows;
        use(block);
        for (Column& column : block.columns) column.values.clear();
        block.first_row = before;
      }
      parser.Parse(*line, lines.number());
    }
  }
  check.Take(block);
  use(block);
}

Recording ReadCsvHead(const std::filesystem::path& path) {
  LineReader lines(path);
  Places places{path.string()};
  return ReadHead(lines, places);
}

}  // namespace abbe::recording
