// Files that grow, without crashes: what crash_test.cpp does not do to them.
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <condition_variable>
#include <limits>
#include <mutex>
#include <thread>

#include "recording/background_writer.h"
#include "recording/recording_file.h"
#include "recording/whole_file.h"
#include "scratch.h"

namespace abbe::recording {
namespace writer_test {

constexpr const char* kHeader = "kind = \"dwell\"\nmachine = \"m\"";
const std::vector<std::string> kColumns{"time_s", "mood"};

class EachForm : public testing::TestWithParam<std::string> {
 protected:
  const Scratch scratch_;
  const std::filesystem::path path_ = scratch_ / ("a" + GetParam());
};

TEST_P(EachForm, HoldsWhatWasAppended) {
  constexpr int kRows = 200'000;  // more than may wait in memory
  {
    const auto writer = Writer::Create(path_, kHeader, kColumns);
    for (int i = 0; i < kRows; ++i)
      writer->Append(std::array{1.0 * i, i % 3 == 0 ? std::nan("7") : 0.5 * i});
  }  // the destructor closes
  const Recording recording = Read(path_);
  EXPECT_TRUE(recording.warnings.empty());
  EXPECT_EQ(recording.header, std::string(kHeader) + "\n");
  ASSERT_EQ(recording.rows(), static_cast<std::size_t>(kRows));
  for (int i = 0; i < kRows; ++i) {
    ASSERT_EQ(recording.columns[0].values[i], i);
    if (i % 3 == 0) {
      ASSERT_TRUE(std::isnan(recording.columns[1].values[i]));
    } else {
      ASSERT_EQ(recording.columns[1].values[i], 0.5 * i);
    }
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(scratch_.folder()), {}), 1);
}

TEST_P(EachForm, NeverOverwritesWhatWasMeasured) {
  Put(path_, "precious");
  const auto message = MessageOf<InputError>([&] { Writer::Create(path_, kHeader, kColumns); });
  ExpectHas(message, path_.string() + ": exists already");
  EXPECT_EQ(Bytes(path_), "precious");
}

TEST_P(EachForm, LeavesNoFileWhereItsHeaderIsRefused) {
  MessageOf<InputError>([&] { Writer::Create(path_, "kind = 3", kColumns); });
  MessageOf<InputError>([&] { Writer::Create(path_, kHeader, {"time_s", "a,b"}); });
  MessageOf<InputError>([&] { Writer::Create(path_, kHeader, {}); });
  EXPECT_TRUE(std::filesystem::is_empty(scratch_.folder()));
}

TEST_P(EachForm, SaysThatAFolderCannotBeWritten) {
  const auto below_a_file = scratch_ / "file";
  Put(below_a_file, "");
  for (const auto& folder : {below_a_file, scratch_ / "none", std::filesystem::path("/proc")}) {
    const auto path = folder / ("a" + GetParam());
    ExpectHas(MessageOf<InputError>([&] { Writer::Create(path, kHeader, kColumns); }),
              "cannot be created");
    ExpectHas(MessageOf<InputError>([&] { Write(Dwell(1), path); }), "cannot be created");
  }
  if (geteuid() == 0) return;  // root may write everywhere
  chmod(scratch_.folder().c_str(), 0500);
  ExpectHas(MessageOf<InputError>([&] { Writer::Create(path_, kHeader, kColumns); }),
            "Permission denied");
  chmod(scratch_.folder().c_str(), 0700);
}

TEST_P(EachForm, RefusesARowOfAnotherWidth) {
  const auto writer = Writer::Create(path_, kHeader, kColumns);
  ExpectHas(MessageOf<InputError>([&] { writer->Append(std::array{1.0}); }), "row of 1 values");
  writer->Append(std::array{1.0, 2.0});
  writer->Close();
  writer->Close();
  EXPECT_EQ(Read(path_).rows(), 1u);
  EXPECT_THROW(writer->Append(std::array{1.0, 2.0}), std::logic_error);
}

TEST_P(EachForm, OverwritesAtOnceOrNotAtAll) {
  Write(Dwell(5), path_);
  SetOverwriting({{}, true});
  Write(Dwell(3), path_);
  EXPECT_EQ(Read(path_).rows(), 3u);
  Recording bad = Dwell(3);
  bad.columns[0].values[1] = -1.0;
  MessageOf<InputError>([&] { Write(bad, path_); });
  SetOverwriting({});
  EXPECT_EQ(Read(path_).rows(), 3u);
}

// Several recorders at the same time, as in a program with several devices. The threads only write:
// reading makes a process (see Hdf5Child), and the sanitizer's own locks do not survive a fork among
// threads that allocate.
TEST_P(EachForm, WritesFromManyThreads) {
  constexpr int kThreads = 4;
  const auto path = [&](int t) { return scratch_ / (std::to_string(t) + GetParam()); };
  {
    std::vector<std::jthread> threads;
    threads.reserve(kThreads);
    for (int t = 0; t < kThreads; ++t) {
      threads.emplace_back([&, t] {
        const auto writer = Writer::Create(path(t), kHeader, kColumns);
        for (int i = 0; i < 5000; ++i) {
          writer->Append(std::array{1.0 * i, 1.0 * t});
          if (i % 500 == 0) writer->Flush();
        }
        writer->Close();
      });
    }
  }
  for (int t = 0; t < kThreads; ++t) {
    const Recording recording = Read(path(t));
    ASSERT_EQ(recording.rows(), 5000u);
    EXPECT_EQ(recording.columns[1].values[4999], t);
  }
}

INSTANTIATE_TEST_SUITE_P(Forms, EachForm, testing::Values(".csv", ".h5", ".HDF5"),
                         [](const auto& form) { return form.param.substr(1); });

TEST(WriterTest, SaysThatADeviceIsFull) {
  const Scratch scratch;
  // A device of ours that is always full: never risk that of the computer.
  const auto path = scratch / "a.csv";
  if (mknod(path.c_str(), S_IFCHR | 0600, (1 << 8) | 7) != 0) GTEST_SKIP() << "needs root";
  if (!std::ofstream(path).is_open()) GTEST_SKIP() << "no devices in this folder";
  ExpectHas(MessageOf<DeviceError>([&] { Write(Dwell(10), path); }), "disk full");
  EXPECT_TRUE(std::filesystem::is_character_file(path));
}

// A disk that confirms nothing until it is allowed to.
class SlowDisk : public RowFile {
 public:
  struct State {
    std::mutex mutex;
    std::condition_variable changed;
    std::size_t values = 0;  // with the kernel
    bool syncing = false, may_sync = false;

    template <typename Is>
    bool Await(Is is) {
      std::unique_lock lock(mutex);
      return changed.wait_for(lock, std::chrono::seconds(60), [&] { return is(*this); });
    }
    template <typename Do>
    void Change(Do change) {
      const std::lock_guard lock(mutex);
      change(*this);
      changed.notify_all();
    }
  };
  explicit SlowDisk(State& state) : state_(state) {}
  void Write(std::span<const double> rows) override {
    state_.Change([&](State& s) { s.values += rows.size(); });
  }
  void Sync() override {
    state_.Change([](State& s) { s.syncing = true; });
    state_.Await([](State& s) { return s.may_sync; });
  }
  void Close() override {}

 private:
  State& state_;
};

TEST(BackgroundWriter, HandsRowsToTheKernelWhileTheDiskIsSlow) {
  SlowDisk::State state;
  BackgroundWriter writer("a.csv", std::make_unique<SlowDisk>(state), 1);
  writer.Append(std::array{1.0});
  ASSERT_TRUE(state.Await([](SlowDisk::State& s) { return s.syncing; }));
  // What comes while the disk has not confirmed the first row waits for nothing but the next write.
  writer.Append(std::array{2.0});
  EXPECT_TRUE(state.Await([](SlowDisk::State& s) { return s.values == 2; }));
  EXPECT_FALSE(state.may_sync);
  state.Change([](SlowDisk::State& s) { s.may_sync = true; });
  writer.Close();
}

// A disk that takes rows and never confirms them.
class BrokenDisk : public RowFile {
 public:
  void Write(std::span<const double>) override {}
  void Sync() override { throw DeviceError("a.csv: disk full"); }
  void Close() override {}
};

TEST(BackgroundWriter, SaysThatTheDiskDidNotConfirm) {
  BackgroundWriter writer("a.csv", std::make_unique<BrokenDisk>(), 1);
  writer.Append(std::array{1.0});
  MessageOf<DeviceError>([&] { writer.Flush(); });
  MessageOf<DeviceError>([&] { writer.Append(std::array{2.0}); });
  MessageOf<DeviceError>([&] { writer.Close(); });
}

}  // namespace writer_test
}  // namespace abbe::recording
