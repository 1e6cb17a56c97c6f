// CSV and HDF5 hold the same: random recordings go through both, in either order, twice.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "recording/recording_file.h"
#include "scratch.h"

namespace abbe::recording {
namespace round_trip_test {

// Any double, each exponent as likely as another; every NaN is the plain one, as in the CSV form.
rc::Gen<double> AnyDouble() {
  return rc::gen::map(rc::gen::arbitrary<std::uint64_t>(), [](std::uint64_t bits) {
    // The bits of RapidCheck's small numbers are mixed, or all doubles would be denormal.
    const auto value = std::bit_cast<double>(bits * 0x9e3779b97f4a7c15ULL);
    return std::isnan(value) ? std::numeric_limits<double>::quiet_NaN() : value;
  });
}

rc::Gen<std::string> TextOf(const std::string& letters) {
  return rc::gen::container<std::string>(rc::gen::elementOf(letters));
}

Recording AnyRecording() {
  Recording recording;
  recording.header = "kind = \"dwell\"\n";
  for (const auto& line :
       *rc::gen::container<std::vector<std::string>>(TextOf("ab #='\",.\t[]\xC2\xB5"))) {
    // A comment takes any text; UTF-8 needs its bytes in pairs.
    std::string valid;
    for (const char c : line) {
      if (c >= 0) valid += c;
    }
    recording.header += "#" + valid + "\n";
  }
  for (const auto& value : *rc::gen::container<std::vector<std::string>>(TextOf("xyz_ -\\"))) {
    recording.header += "key_" + std::to_string(recording.header.size()) + " = '" + value + "'\n";
  }
  const auto rows = *rc::gen::inRange<std::size_t>(0, 40);
  const auto extra = *rc::gen::inRange<std::size_t>(0, 6);
  std::vector<double> time;
  for (std::size_t i = 0; i < rows; ++i) time.push_back(0.1 * static_cast<double>(i));
  recording.columns.push_back({"time_s", time});
  for (std::size_t c = 0; c < extra; ++c) {
    recording.columns.push_back({"extra " + *TextOf("abc_%()") + std::to_string(c),
                                 *rc::gen::container<std::vector<double>>(rows, AnyDouble())});
  }
  return recording;
}

void AssertSame(const Recording& a, const Recording& b) {
  RC_ASSERT(a.header == b.header);
  RC_ASSERT(a.columns.size() == b.columns.size());
  for (std::size_t c = 0; c < a.columns.size(); ++c) {
    RC_ASSERT(a.columns[c].name == b.columns[c].name);
    RC_ASSERT(a.columns[c].values.size() == b.columns[c].values.size());
    for (std::size_t i = 0; i < a.columns[c].values.size(); ++i) {
      RC_ASSERT(std::bit_cast<std::uint64_t>(a.columns[c].values[i]) ==
                std::bit_cast<std::uint64_t>(b.columns[c].values[i]));
    }
  }
}

// Writes and reads through these files, one after the other; the last two of one form are the same
// bytes.
void Through(const Recording& recording, const std::vector<std::string>& names) {
  const Scratch scratch;
  Recording current = recording;
  for (const std::string& name : names) {
    Write(current, scratch / name);
    current = Read(scratch / name);
    RC_ASSERT(current.warnings.empty());
    AssertSame(current, recording);
  }
  RC_ASSERT(Bytes(scratch / names[0]) == Bytes(scratch / names[2]));
}

RC_GTEST_PROP(RoundTrip, IsExactFromCsv, ()) {
  Through(AnyRecording(), {"a.csv", "b.h5", "c.csv", "d.hdf5"});
}

RC_GTEST_PROP(RoundTrip, IsExactFromHdf5, ()) {
  const Scratch scratch;
  const Recording recording = AnyRecording();
  Recording current = recording;
  for (const std::string name : {"a.h5", "b.csv", "c.h5", "d.csv"}) {
    Write(current, scratch / name);
    current = Read(scratch / name);
    AssertSame(current, recording);
  }
}

RC_GTEST_PROP(RoundTrip, IsExactForFilesThatGrow, ()) {
  const Recording recording = AnyRecording();
  std::vector<std::string> names;
  for (const Column& column : recording.columns) names.push_back(column.name);
  for (const std::string file : {"a.csv", "a.h5"}) {
    const Scratch scratch;
    const auto writer = Writer::Create(scratch / file, recording.header, names);
    std::vector<double> row(names.size());
    for (std::size_t i = 0; i < recording.rows(); ++i) {
      for (std::size_t c = 0; c < row.size(); ++c) row[c] = recording.columns[c].values[i];
      writer->Append(row);
    }
    writer->Close();
    AssertSame(Read(scratch / file), recording);
  }
}

RC_GTEST_PROP(Blocks, AreTheWhole, ()) {
  const Recording recording = AnyRecording();
  const auto rows = *rc::gen::inRange<std::size_t>(1, 45);
  const Scratch scratch;
  for (const std::string name : {"a.csv", "a.h5"}) {
    Write(recording, scratch / name);
    std::size_t largest = 0;
    AssertSame(Joined([&](const UseBlock& use) {
                 const auto see = [&](const Recording& block) {
                   largest = std::max(largest, block.rows());
                   use(block);
                 };
                 ReadBlocks(scratch / name, see, rows);
               }),
               recording);
    RC_ASSERT(largest == std::min(rows, recording.rows()));
    Recording head = recording;
    for (Column& column : head.columns) column.values.clear();
    AssertSame(ReadHead(scratch / name), head);
  }
}

}  // namespace round_trip_test
}  // namespace abbe::recording
