// `recording/csv_reader.h`: whole and block by block it is the same recording.
#include <cmath>

#include "fuzz/target.h"
#include "recording/csv_reader.h"

namespace abbe::fuzz::recording_csv {

constexpr std::size_t kFewRows = 3, kManyRows = 16384;

struct Sum {
  std::size_t rows = 0, numbers = 0;  // numbers: that are no NaN
};

Sum SumOf(const std::filesystem::path& path, std::size_t rows) {
  Sum sum;
  recording::ReadCsv(path, rows, [&](const recording::Recording& block) {
    Require(block.first_row == sum.rows, "blocks follow one another");
    sum.rows += block.rows();
    for (const auto& column : block.columns) {
      Require(column.values.size() == block.rows(), "columns are of one length");
      for (const double value : column.values) sum.numbers += std::isnan(value) ? 0 : 1;
    }
  });
  return sum;
}

void Read(Bytes bytes) {
  const InputFile file(bytes);
  const Sum whole = SumOf(file.path(), kManyRows), parts = SumOf(file.path(), kFewRows);
  Require(whole.rows == parts.rows && whole.numbers == parts.numbers,
          "blocks together are the whole recording");
  Require(recording::ReadCsvHead(file.path()).rows() == 0, "a head has no rows");
}

}  // namespace abbe::fuzz::recording_csv
