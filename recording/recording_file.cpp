#include "recording/recording_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>
#include <utility>

#include "recording/background_writer.h"
#include "recording/check.h"
#include "recording/csv_reader.h"
#include "recording/csv_writer.h"
#include "recording/hdf5_reader.h"
#include "recording/hdf5_writer.h"
#include "recording/row_file.h"
#include "recording/whole_file.h"

namespace abbe::recording {
namespace {

constexpr std::string_view kHdf5Begin = "\x89HDF\r\n\x1a\n";

constexpr std::size_t kWhole = std::numeric_limits<std::size_t>::max();  // rows of a block

constexpr std::string_view kSpreadsheet =
    "is the workbook of a spreadsheet; save its sheet as CSV there, and make a recording of that "
    "by abbe convert TABLE.csv RECORDING.csv --column NAME=COLUMN";
constexpr std::string_view kMatlab =
    "is a file of MATLAB; write its columns there as CSV (writetable), and make a recording of "
    "that by abbe convert TABLE.csv RECORDING.csv --column NAME=COLUMN";
constexpr std::string_view kOtherProgram =
    "is a table of another program; write it there as CSV, and make a recording of that by abbe "
    "convert TABLE.csv RECORDING.csv --column NAME=COLUMN";
constexpr std::string_view kImportable =
    "is not a recording, which ends in .csv, .h5 or .hdf5; abbe convert makes one of a table "
    "(.dat, "
    ".txt) or a log (.log)";
constexpr std::string_view kProgram =
    "is an NC program, not a recording; are two arguments swapped?";

enum class Form { kCsv, kHdf5 };

// Advice for a file that is not a recording, by its extension.
std::string_view WhatToDo(std::string_view extension) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 15> kKnown{{
      {".xlsx", kSpreadsheet},
      {".xls", kSpreadsheet},
      {".ods", kSpreadsheet},
      {".mat", kMatlab},
      {".tdms", kOtherProgram},
      {".dat", kImportable},
      {".txt", kImportable},
      {".log", kImportable},
      {".tsv", kOtherProgram},
      {".toml",
       "is a file of settings (a machine file, a map), not a recording; are two arguments "
       "swapped?"},
      {".json", "is a result, not a recording; are two arguments swapped?"},
      {".ngc", kProgram},
      {".nc", kProgram},
      {".mpf", kProgram},
      {".html", "is a report, not a recording; are two arguments swapped?"},
  }};
  for (const auto& [end, advice] : kKnown) {
    if (extension == end) return advice;
  }
  return "is not the name of a recording, which ends in .csv, .h5 or .hdf5; check the path";
}

Form FormOf(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (extension == ".csv") return Form::kCsv;
  if (extension == ".h5" || extension == ".hdf5") return Form::kHdf5;
  throw InputError(fmt::format("{}: {}", path.string(), WhatToDo(extension)));
}

std::string Begin(const std::filesystem::path& path) {
  const std::string name = path.string();
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    throw InputError(fmt::format("{}: there is no such file; check the path", name));
  }
  if (!std::filesystem::is_regular_file(status)) {
    throw InputError(
        fmt::format("{}: is {}, not a file; check the path", name,
                    std::filesystem::is_directory(status) ? "a folder" : "a device or a pipe"));
  }
  std::ifstream file(path, std::ios::binary);
  std::string begin(kHdf5Begin.size(), '\0');
  file.read(begin.data(), begin.size());
  if (!file.is_open() || file.bad()) {
    throw InputError(
        fmt::format("{}: cannot be read: {}; check the path", name, std::strerror(errno)));
  }
  begin.resize(file.gcount());
  if (begin.empty())
    throw InputError(fmt::format("{}: the file is empty; nothing was recorded", name));
  return begin;
}

// The form according to name and content, which must agree.
Form FoundForm(const std::filesystem::path& path) {
  const Form form = FormOf(path);
  const bool hdf5 = Begin(path) == kHdf5Begin;
  if (form == Form::kCsv && hdf5) {
    throw InputError(fmt::format(
        "{}: is an HDF5 file under the name of a CSV file; rename it to .h5", path.string()));
  }
  if (form == Form::kHdf5 && !hdf5) {
    throw InputError(
        fmt::format("{}: is not an HDF5 file; check the path, or name it .csv if it is a CSV file",
                    path.string()));
  }
  return form;
}

// The header as stored in both forms: lines that end in "\n".
std::string KeptHeader(std::string_view header) {
  std::string kept;
  while (!header.empty()) {
    const std::size_t end = std::min(header.find('\n'), header.size());
    std::string_view line = header.substr(0, end);
    header.remove_prefix(std::min(end + 1, header.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    kept.append(line).append("\n");
  }
  return kept;
}

}  // namespace

Recording Read(const std::filesystem::path& path) {
  Recording whole;
  const auto take = [&](Recording& block) { whole = std::move(block); };
  (FoundForm(path) == Form::kCsv ? ReadCsv : ReadHdf5)(path, kWhole, take);
  return whole;
}

void ReadBlocks(const std::filesystem::path& path, const UseBlock& use, std::size_t rows) {
  (FoundForm(path) == Form::kCsv ? ReadCsv : ReadHdf5)(path, rows, use);
}

Recording ReadHead(const std::filesystem::path& path) {
  return (FoundForm(path) == Form::kCsv ? ReadCsvHead : ReadHdf5Head)(path);
}

void Write(const Recording& recording, const std::filesystem::path& path) {
  const Form form = FormOf(path);
  Check(recording, Places{path.string()});
  WholeFile file(path);
  (form == Form::kCsv ? WriteCsv : WriteHdf5)(recording, KeptHeader(recording.header), file);
  file.Finish();
}

std::unique_ptr<Writer> Writer::Create(const std::filesystem::path& path, const std::string& header,
                                       const std::vector<std::string>& columns) {
  const Form form = FormOf(path);
  const std::string kept = KeptHeader(header);
  CheckColumnNames(columns, path.string());
  CheckHeader(kept, columns, Places{path.string()});
  auto file = (form == Form::kCsv ? CreateCsv : CreateHdf5)(path, kept, columns);
  return std::make_unique<BackgroundWriter>(path.string(), std::move(file), columns.size());
}

}  // namespace abbe::recording
