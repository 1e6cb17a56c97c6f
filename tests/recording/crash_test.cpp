// Recorders that are killed, and disks that fill up. Each recorder is a process of its own.
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <thread>

#include "random/counter_random.h"
#include "recording/recording_file.h"
#include "scratch.h"
#include "tests/seeds.h"

namespace abbe::recording {
namespace crash_test {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr std::size_t kParts = 256;
const std::vector<std::string> kColumns{"time_s", "x_mm", "a", "b", "c", "flags"};

// Row `i` of every recorder here: whoever reads it back can tell whether it is whole.
std::array<double, 6> RowAt(std::uint64_t i) {
  const auto t = static_cast<double>(i);
  return {0.001 * t, 7.0 * t + 1.0, -t, t * t, 1.0 / (1.0 + t), 0.0};
}

// How far a recorder got, seen from outside.
struct Progress {
  std::atomic<std::uint64_t> appended{0};
  std::atomic<std::uint64_t> flushed{0};
};

class Recorder {
 public:
  // Runs `work` in a process of its own.
  template <typename Work>
  explicit Recorder(const Work& work)
      : progress_(new (mmap(nullptr, sizeof(Progress), PROT_READ | PROT_WRITE,
                            MAP_SHARED | MAP_ANONYMOUS, -1, 0)) Progress) {
    child_ = fork();
    if (child_ == 0) _exit(work(*progress_));
  }
  ~Recorder() { munmap(progress_, sizeof(Progress)); }
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  const Progress& progress() const { return *progress_; }
  int Wait() {
    int status = 0;
    waitpid(child_, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  void Kill() {
    kill(child_, SIGKILL);
    EXPECT_EQ(Wait(), -1) << "the recorder ended before it was killed";
  }

 private:
  Progress* progress_;
  pid_t child_;
};

void ExpectRows(const Recording& recording, std::uint64_t at_least) {
  ASSERT_EQ(recording.columns.size(), kColumns.size());
  EXPECT_GE(recording.rows(), at_least);
  for (std::size_t i = 0; i < recording.rows(); ++i) {
    const auto expected = RowAt(i);
    for (std::size_t c = 0; c < kColumns.size(); ++c) {
      ASSERT_EQ(recording.columns[c].values[i], expected[c]) << "row " << i << " column " << c;
    }
  }
}

class Crash : public testing::TestWithParam<std::string> {};

// A folder in memory, where there is one: no waiting for a disk, so a recorder writes all the time.
std::filesystem::path FastFolder() {
  return std::filesystem::exists("/dev/shm") ? "/dev/shm" : std::filesystem::temp_directory_path();
}

// Flushes again and again, so that the kill comes in the middle of a flush nearly always.
TEST_P(Crash, KeepsEveryRowThatWasFlushed) {
  const random::CounterRandom random(20261121, 1);
  std::uint64_t flushed = 0;
  const std::uint64_t trials = SeedsFromEnvironment().last;
  for (std::uint64_t trial = 0; trial < trials; ++trial) {
    const Scratch scratch(FastFolder());
    const auto path = scratch / ("a" + GetParam());
    Recorder recorder([&](Progress& progress) {
      const auto writer = Writer::Create(path, "kind = \"dwell\"", kColumns);
      for (std::uint64_t i = 0;; ++i) {
        writer->Append(RowAt(i));
        if (i % 37 != 0) continue;
        writer->Flush();
        progress.flushed = i + 1;
      }
      return 0;
    });
    while (recorder.progress().flushed == 0) std::this_thread::sleep_for(microseconds(100));
    std::this_thread::sleep_for(microseconds(static_cast<int>(random.Uniform(trial, 0.0, 2e4))));
    recorder.Kill();
    const Recording recording = Read(path);
    ExpectRows(recording, recorder.progress().flushed);
    const Recording joined = Joined([&](const UseBlock& use) { ReadBlocks(path, use, 500); });
    ExpectRows(joined, recording.rows());
    EXPECT_EQ(joined.warnings, recording.warnings);
    flushed += recorder.progress().flushed;
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(flushed, trials * 37);
}

// Never flushes by itself and falls silent after a while: the rows that are a second old are there.
TEST_P(Crash, LosesAtMostTheLastSecond) {
  const random::CounterRandom random(20261121, 2);
  for (std::uint64_t trial = 0; trial < 4; ++trial) {
    const Scratch scratch;
    const auto path = scratch / ("a" + GetParam());
    Recorder recorder([&](Progress& progress) {
      const auto writer = Writer::Create(path, "kind = \"dwell\"", kColumns);
      for (std::uint64_t i = 0; i < 700; ++i) {
        writer->Append(RowAt(i));
        progress.appended = i + 1;
        std::this_thread::sleep_for(milliseconds(1));
      }
      std::this_thread::sleep_for(std::chrono::hours(1));
      return 0;
    });
    std::this_thread::sleep_for(microseconds(static_cast<int>(random.Uniform(trial, 1e5, 6e5))));
    const std::uint64_t a_second_old = recorder.progress().appended;
    std::this_thread::sleep_for(milliseconds(1000));
    recorder.Kill();
    ExpectRows(Read(path), a_second_old);
  }
}

// After a power cut a file may lack its end too: what is kept are rows as they were, never zeros.
TEST_P(Crash, KeepsOnlyTrueRowsOfAFileThatWasCutToo) {
  const Scratch scratch(FastFolder());
  const auto path = scratch / ("a" + GetParam());
  Recorder recorder([&](Progress& progress) {
    const auto writer = Writer::Create(path, "kind = \"dwell\"", kColumns);
    for (std::uint64_t i = 0;; ++i) {
      writer->Append(RowAt(i));
      if (i % 97 != 0) continue;
      writer->Flush();
      progress.flushed = i + 1;
    }
    return 0;
  });
  while (recorder.progress().flushed < 10'000) std::this_thread::sleep_for(microseconds(100));
  recorder.Kill();
  const std::string whole = Bytes(path);
  std::uint64_t saved = 0;
  for (std::size_t part = 1; part < kParts; ++part) {
    Put(path, std::string_view(whole).substr(0, whole.size() * part / kParts));
    try {
      const Recording kept = Read(path);
      ExpectRows(kept, 0);
      EXPECT_EQ(kept.warnings.empty(), Bytes(path).ends_with('\n'));
      saved = std::max<std::uint64_t>(saved, kept.rows());
    } catch (const InputError&) {
    }
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(saved, 5'000u);
}

// While its recorder lives, a file can be read, and what was read before stays as it was.
TEST_P(Crash, ReadsWhileTheFileGrows) {
  const Scratch scratch;
  const auto path = scratch / ("a" + GetParam());
  Recorder recorder([&](Progress& progress) {
    const auto writer = Writer::Create(path, "kind = \"dwell\"", kColumns);
    for (std::uint64_t i = 0;; ++i) {
      writer->Append(RowAt(i));
      if (i % 37 != 0) continue;
      writer->Flush();
      progress.flushed = i + 1;
    }
    return 0;
  });
  while (recorder.progress().flushed == 0) std::this_thread::sleep_for(microseconds(100));
  for (int i = 0; i < 50; ++i) {
    const std::uint64_t flushed = recorder.progress().flushed;
    ExpectRows(Read(path), flushed);
  }
  recorder.Kill();
}

// The limit on the size of a file stands for a disk that is full: the kernel refuses the write in
// both.
TEST_P(Crash, KeepsTheRowsBeforeTheDiskWasFull) {
  for (const rlim_t limit : {200'000, 333'333, 1'000'000}) {
    const Scratch scratch;
    const auto path = scratch / ("a" + GetParam());
    Recorder recorder([&](Progress& progress) {
      std::signal(SIGXFSZ, SIG_IGN);
      const rlimit size{limit, limit};
      setrlimit(RLIMIT_FSIZE, &size);
      const auto writer = Writer::Create(path, "kind = \"dwell\"", kColumns);
      try {
        for (std::uint64_t i = 0; i < 1'000'000; ++i) {
          writer->Append(RowAt(i));
          if (i % 37 != 0) continue;
          writer->Flush();
          progress.flushed = i + 1;
        }
      } catch (const DeviceError& failure) {
        const std::string message = failure.what();
        if (message.find("disk full") == std::string::npos) return 2;
        try {
          writer->Append(RowAt(0));
          return 3;  // a row went nowhere without a word
        } catch (const DeviceError&) {
          return 0;
        }
      }
      return 1;
    });
    EXPECT_EQ(recorder.Wait(), 0);
    EXPECT_GT(recorder.progress().flushed, 0u);
    ExpectRows(Read(path), recorder.progress().flushed);
  }
}

TEST_P(Crash, LeavesNothingWhereAWholeFileDoesNotFit) {
  const Scratch scratch;
  const auto path = scratch / ("a" + GetParam());
  Recorder recorder([&](Progress&) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit size{20'000, 20'000};
    setrlimit(RLIMIT_FSIZE, &size);
    try {
      Write(Dwell(100'000), path);
    } catch (const DeviceError& failure) {
      return std::string(failure.what()).find("disk full") == std::string::npos ? 2 : 0;
    }
    return 1;
  });
  EXPECT_EQ(recorder.Wait(), 0);
  EXPECT_TRUE(std::filesystem::is_empty(scratch.folder()));
}

INSTANTIATE_TEST_SUITE_P(Forms, Crash, testing::Values(".csv", ".h5"), [](const auto& form) {
  return form.param == ".csv" ? std::string("Csv") : std::string("Hdf5");
});

}  // namespace crash_test
}  // namespace abbe::recording
