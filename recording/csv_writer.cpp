#include "recording/csv_writer.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <vector>

#include "recording/csv_form.h"
#include "recording/output_file.h"
#include "recording/row_file.h"

namespace abbe::recording {
namespace {

constexpr std::size_t kBytesHeld = std::size_t{1} << 16;

// Lines of text, buffered before they go to the file.
class Lines {
 public:
  void Header(const std::string& header, const std::vector<std::string>& columns) {
    text_.append(kSignature).append("\n");
    for (std::size_t begin = 0; begin < header.size();) {
      const std::size_t end = std::min(header.find('\n', begin), header.size());
      text_.append(begin == end ? "#" : "# ").append(header, begin, end - begin).append("\n");
      begin = end + 1;
    }
    for (std::size_t c = 0; c < columns.size(); ++c) {
      text_.append(c == 0 ? "" : ",").append(columns[c]);
    }
    text_ += '\n';
  }

  // The shortest text that reads back as the same double; every NaN is "nan".
  void Field(double value, bool last) {
    if (std::isnan(value)) {
      text_.append("nan");
    } else {
      std::array<char, 32> digits;
      char* const end = std::to_chars(digits.begin(), digits.end(), value).ptr;
      text_.append(digits.begin(), end);
    }
    text_ += last ? '\n' : ',';
  }

  std::size_t size() const { return text_.size(); }
  template <typename File>
  void MoveTo(File& file) {
    file.Append(text_);
    text_.clear();
  }

 private:
  std::string text_;
};

class CsvRowFile : public RowFile {
 public:
  CsvRowFile(const std::filesystem::path& path, const std::string& header,
             const std::vector<std::string>& columns)
      : file_(path), columns_(columns.size()) {
    lines_.Header(header, columns);
    lines_.MoveTo(file_);
    file_.Sync();
  }

  void Write(std::span<const double> rows) override {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      lines_.Field(rows[i], (i + 1) % columns_ == 0);
    }
    lines_.MoveTo(file_);
  }
  void Sync() override { file_.Sync(); }
  void Close() override { file_.Close(); }

 private:
  OutputFile file_;
  std::size_t columns_;
  Lines lines_;
};

}  // namespace

std::unique_ptr<RowFile> CreateCsv(const std::filesystem::path& path, const std::string& header,
                                   const std::vector<std::string>& columns) {
  return std::make_unique<CsvRowFile>(path, header, columns);
}

void WriteCsv(const Recording& recording, const std::string& header, WholeFile& file) {
  std::vector<std::string> names;
  for (const Column& column : recording.columns) names.push_back(column.name);
  Lines lines;
  lines.Header(header, names);
  for (std::size_t row = 0; row < recording.rows(); ++row) {
    for (const Column& column : recording.columns) {
      lines.Field(column.values[row], &column == &recording.columns.back());
    }
    if (lines.size() > kBytesHeld) lines.MoveTo(file);
  }
  lines.MoveTo(file);
}

}  // namespace abbe::recording
