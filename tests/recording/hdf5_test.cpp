// The HDF5 form: what other programs see in it, and what happens to one that is not whole.
#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstdlib>

#include "recording/recording_file.h"
#include "scratch.h"

namespace abbe::recording {
namespace hdf5_test {

class Hdf5 : public testing::Test {
 protected:
  std::string Refusal(const std::filesystem::path& path) {
    return MessageOf<InputError>([&] { Read(path); });
  }

  const Scratch scratch_;
  const std::filesystem::path path_ = scratch_ / "a.h5";
};

TEST_F(Hdf5, KeepsHeaderNamesOrderAndBits) {
  Recording recording = Dwell(3);
  recording.header = "kind = \"dwell\"\n# \xC2\xB5m, by hand\n\nmachine = \"m\"\n";
  recording.columns.push_back(
      {"a column of mine", {-0.0, 5e-324, std::bit_cast<double>(0x7ff8000000000123ULL)}});
  recording.columns.push_back({"0 first by name", {1e308, -1e-308, 0.1}});
  Write(recording, path_);
  const Recording back = Read(path_);
  EXPECT_EQ(back.header, recording.header);
  EXPECT_TRUE(back.warnings.empty());
  ASSERT_EQ(back.columns.size(), recording.columns.size());
  for (std::size_t c = 0; c < back.columns.size(); ++c) {
    EXPECT_EQ(back.columns[c].name, recording.columns[c].name);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(std::bit_cast<std::uint64_t>(back.columns[c].values[i]),
                std::bit_cast<std::uint64_t>(recording.columns[c].values[i]));
    }
  }
}

TEST_F(Hdf5, ReadsAHeaderLongerThanAnObjectHeaderHolds) {
  Recording recording = Dwell(1);
  for (int i = 0; i < 10'000; ++i) recording.header += "# a long story about this machine\n";
  Write(recording, path_);
  EXPECT_EQ(Read(path_).header, recording.header);
  const auto grown = scratch_ / "grown.h5";
  Writer::Create(grown, recording.header, {"time_s"})->Close();
  EXPECT_EQ(Read(grown).header, recording.header);
}

TEST_F(Hdf5, WarnsThatThereIsNoRow) {
  Write(Dwell(0), path_);
  const Recording back = Read(path_);
  EXPECT_EQ(back.rows(), 0u);
  EXPECT_EQ(back.columns.size(), 3u);
}

TEST_F(Hdf5, RefusesAFileThatWasCut) {
  Write(Dwell(30'000), path_);
  const std::string whole = Bytes(path_);
  for (std::size_t part = 1; part < 64; ++part) {
    Put(path_, std::string_view(whole).substr(0, whole.size() * part / 64));
    ExpectHas(Refusal(path_), "cannot be opened: truncated file");
  }
}

// Reads the file with every seventh byte changed in turn. 0: each was read or refused.
int ReadWithChangedBytes(const std::filesystem::path& path) {
  const std::string whole = Bytes(path);
  for (std::size_t at = 8; at < whole.size(); at += 7) {
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ 0x55);
    Put(path, changed);
    try {
      if (Read(path).rows() > 100) return 1;
    } catch (const InputError&) {
      // Told by a checksum, a rule or a name.
    }
  }
  return 0;
}

// A byte that changed on the disk is told, or is one number: never a crash. In a process of its
// own, because HDF5 itself loses memory over damaged files.
TEST_F(Hdf5, SurvivesChangedBytes) {
  Write(Dwell(100), path_);
  EXPECT_EXIT(_exit(ReadWithChangedBytes(path_)), testing::ExitedWithCode(0), "");
}

TEST_F(Hdf5, RefusesOtherFiles) {
  Put(path_, "");
  ExpectHas(Refusal(path_), "a.h5: the file is empty");
  Put(path_, "# abbe-recording = 1\n");
  ExpectHas(Refusal(path_), "is not an HDF5 file");
  Put(path_, "\x89HDF\r\n\x1a\n");
  ExpectHas(Refusal(path_), "cannot be opened");
  std::filesystem::create_directory(scratch_ / "folder.h5");
  ExpectHas(Refusal(scratch_ / "folder.h5"), "folder");
  ExpectHas(Refusal(scratch_ / "none.hdf5"), "no such file");
}

// The same file seen by another program.
class Hdf5ByH5py : public Hdf5 {
 protected:
  void SetUp() override {
    if (Run("import h5py") != 0) GTEST_SKIP() << "skipped: python3-h5py is not installed";
  }
  int Run(const std::string& script) {
    Put(scratch_ / "script.py", "import sys\n" + script + "\n");
    const auto command = "/usr/bin/python3 '" + (scratch_ / "script.py").string() + "' '" +
                         path_.string() + "' 2>'" + (scratch_ / "errors").string() + "'";
    const int result = std::system(command.c_str());
    errors_ = Bytes(scratch_ / "errors");
    return result;
  }
  std::string errors_;
};

TEST_F(Hdf5ByH5py, IsReadAsDocumented) {
  const std::string script = R"(
import h5py
f = h5py.File(sys.argv[1])
assert f.attrs["abbe-recording"] == 1
header = f.attrs["header"]
assert (header.decode() if isinstance(header, bytes) else header) == 'kind = "dwell"\n', header
names = []
f.id.links.iterate(lambda name: names.append(name.decode()), idx_type=h5py.h5.INDEX_CRT_ORDER)
assert names == ["time_s", "temp_column_c", "flags"], names
assert f["time_s"].dtype == "<f8" and f["time_s"].shape == (3000,)
units = [f[c].attrs["unit"] for c in names]
assert [u.decode() if isinstance(u, bytes) else u for u in units] == ["s", "degC", ""], units
assert all(f["time_s"][i] == 0.005 * i for i in range(3000))
)";
  Write(Dwell(3000), path_);
  EXPECT_EQ(Run(script), 0) << errors_;
  std::filesystem::remove(path_);
  const auto writer =
      Writer::Create(path_, "kind = \"dwell\"", {"time_s", "temp_column_c", "flags"});
  for (int i = 0; i < 3000; ++i) writer->Append(std::array{0.005 * i, 20.0, 0.0});
  writer->Close();
  EXPECT_EQ(Run(script), 0) << errors_;
}

TEST_F(Hdf5ByH5py, MayBeWrittenByAnother) {
  const std::string script = R"(
import h5py
f = h5py.File(sys.argv[1], "w", track_order=True)
f.attrs["abbe-recording"] = 1
f.attrs["header"] = 'kind = "dwell"\n'
f["time_s"] = [0.0, 1.0, 2.0]
f["count"] = [3, 2, 1]
)";
  ASSERT_EQ(Run(script), 0) << errors_;
  const Recording recording = Read(path_);
  EXPECT_EQ(recording.header, "kind = \"dwell\"\n");
  EXPECT_EQ(recording.columns[1].name, "count");
  EXPECT_EQ(recording.At("count")[0], 3.0);
}

TEST_F(Hdf5ByH5py, NamesWhatIsNoRecording) {
  const auto expect = [&](const std::string& made, std::string_view part) {
    ASSERT_EQ(Run("import h5py\nf = h5py.File(sys.argv[1], 'w')\n" + made), 0) << errors_;
    ExpectHas(Refusal(path_), part);
  };
  const std::string head =
      "f.attrs['abbe-recording'] = 1\nf.attrs['header'] = 'kind = \"dwell\"'\n";
  expect("", "not a recording");
  expect("f.attrs['abbe-recording'] = 7", "version 7");
  expect("f.attrs['abbe-recording'] = 1", "`header`");
  expect(head, "needs a column");
  expect(head + "f['time_s'] = [[1.0, 2.0]]", "time_s: is not a column");
  expect(head + "f['time_s'] = [1.0]\nf.create_group('more')", "more: is not a column");
  expect(head + "f['time_s'] = [1.0]\nf['name'] = ['a']", "name: is not a column");
  expect(head + "f['time_s'] = [1.0, 2.0]\nf['mood'] = [1.0]", "time_s: has 2 rows");
  expect(head + "f['time_s'] = [1.0, 0.5]", "row 2: time_s: goes back");
  expect("f.attrs['abbe-recording'] = 1\nf.attrs['header'] = 'kind = 5x'\nf['time_s'] = [1.0]",
         "header line 1");
}

}  // namespace hdf5_test
}  // namespace abbe::recording
