// HDF5 files that lie: what they state of themselves crashed libhdf5 or this program, ran without
// end, took gigabytes, or brought in the bytes of other files. tests/recording/damaged has those
// that were found; each is refused in one line, in bounded memory and time.
#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "../folders.h"
#include "failure/sanitized.h"
#include "recording/hdf5_child.h"
#include "recording/recording_file.h"
#include "scratch.h"

namespace abbe::recording {
namespace damaged_hdf5_test {

const std::filesystem::path kDamaged = SourceFolder() / "tests/recording/damaged";

std::string RefusalOfDamaged(const std::string& name) {
  return MessageOf<InputError>([&] { Read(kDamaged / name); });
}

TEST(DamagedHdf5, AnAttributeThatIsAnArrayIsNoText) {
  ExpectHas(RefusalOfDamaged("attr_array_header.h5"), "has no text `header`");
  ExpectHas(RefusalOfDamaged("attr_vlen_array_header.h5"), "has no text `header`");
  ExpectHas(RefusalOfDamaged("attr_array_version.h5"), "no number `abbe-recording`");
}

TEST(DamagedHdf5, RowsBeyondTheSizeOfTheFileAreRefused) {
  for (const char* name : {"rows_1e9.h5", "rows_2e18.h5"}) {
    ExpectHas(RefusalOfDamaged(name), "than a file of this size can hold");
  }
  rusage used{};
  getrusage(RUSAGE_CHILDREN, &used);
  EXPECT_LT(used.ru_maxrss, 1'000'000) << "KiB";
}

TEST(DamagedHdf5, NumbersOfOtherFilesAreNotRead) {
  ExpectHas(RefusalOfDamaged("extstorage.h5"), "are in other files");
}

TEST(DamagedHdf5, ABrokenHeapDoesNotEndTheProgram) {
  ExpectHas(RefusalOfDamaged("libhdf5_overlap.h5"), "libhdf5_overlap.h5: ");
  ExpectHas(RefusalOfDamaged("libhdf5_endless.h5"), "libhdf5_endless.h5: ");
}

// Other forms of the same, made by h5py.
class LyingHdf5 : public testing::Test {
 protected:
  void SetUp() override {
    if (std::system("/usr/bin/python3 -c 'import h5py' 2>/dev/null") != 0)
      GTEST_SKIP() << "no h5py";
  }
  std::string RefusalOf(const std::string& columns) {
    Put(scratch_ / "make.py",
        "import sys, h5py, numpy as np\n"
        "f = h5py.File(sys.argv[1], 'w')\n"
        "f.attrs['abbe-recording'] = 1\nf.attrs['header'] = 'kind = \"dwell\"'\n" +
            columns);
    const std::string command =
        "cd " + scratch_.folder().string() + " && /usr/bin/python3 make.py a.h5";
    EXPECT_EQ(std::system(command.c_str()), 0);
    return MessageOf<InputError>([&] { Read(scratch_ / "a.h5"); });
  }
  const Scratch scratch_;
};

TEST_F(LyingHdf5, LinksLeadNowhere) {
  ExpectHas(RefusalOf("g = h5py.File('b.h5', 'w'); g['t'] = [1.0]; g.close()\n"
                      "f['time_s'] = h5py.ExternalLink('b.h5', '/t')\n"),
            "time_s: is a link to another place");
  ExpectHas(RefusalOf("f['time_s'] = [1.0]\nf['again'] = h5py.SoftLink('/time_s')\n"),
            "again: is a link to another place");
}

TEST_F(LyingHdf5, VirtualColumnsAreRefused) {
  ExpectHas(RefusalOf("g = h5py.File('b.h5', 'w'); g['t'] = [1.0]; g.close()\n"
                      "layout = h5py.VirtualLayout(shape=(1,), dtype='f8')\n"
                      "layout[:] = h5py.VirtualSource('b.h5', 't', shape=(1,))\n"
                      "f.create_virtual_dataset('time_s', layout)\n"),
            "time_s: its numbers are in other files");
}

TEST_F(LyingHdf5, RowsThatNobodyWroteAreNoZeros) {
  ExpectHas(RefusalOf("f.create_dataset('time_s', (1000,), 'f8', chunks=(100,))\n"),
            "states 1000 numbers, but the file does not hold them all");
}

TEST_F(LyingHdf5, ForeignFiltersAreNamed) {
  ExpectHas(RefusalOf("f.create_dataset('time_s', data=np.arange(9.0), compression='lzf')\n"),
            "time_s: is packed in a way");
}

// What crashes, loops or eats memory in the child is one line here.
TEST(Hdf5Child, ItsEndIsAFailureOfTheFile) {
  const Scratch scratch;
  const auto path = scratch / "a.h5";
  Put(path, "x");
  const auto refusal = [&](const std::function<void(const Hdf5Sender&)>& read) {
    return MessageOf<InputError>(
        [&] { ReadInChild(path, read, [](char, std::string_view) { return true; }); });
  };
  ExpectHas(refusal([](const Hdf5Sender&) { std::abort(); }), "the HDF5 library crashes on it");
  ExpectHas(refusal([](const Hdf5Sender&) {
              for (std::atomic<int> i = 0;; ++i) {
              }
            }),
            "reading it does not end");
  ExpectHas(refusal([](const Hdf5Sender&) { throw InputError("said so"); }), "said so");
  if (ABBE_ADDRESS_SANITIZER) return;
  ExpectHas(refusal([](const Hdf5Sender& sender) {  // what is not used a compiler may leave out
              sender.Send('v', std::vector<double>(std::size_t{1} << 31));
            }),
            "asks for more memory");
}

// A child that was made while another thread holds the library's lock would wait for ever.
TEST(Hdf5Child, IsMadeWhileOthersUseTheLibrary) {
  if (ABBE_ADDRESS_SANITIZER) {
    GTEST_SKIP() << "the sanitizer's own locks do not survive a fork among threads";
  }
  const Scratch scratch;
  Write(Dwell(100), scratch / "a.h5");
  std::vector<std::jthread> threads;
  for (int t = 0; t < 3; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < 20; ++i) {
        if (t == 0) {
          Writer::Create(scratch / (std::to_string(i) + ".h5"), "kind = \"dwell\"", {"time_s"})
              ->Close();
        } else {
          EXPECT_EQ(Read(scratch / "a.h5").rows(), 100u);
        }
      }
    });
  }
}

// Who asks for the library's lock holds a lock within it for a moment, and a child made in that
// moment hangs in it: the file is not to blame, and another child reads it.
int hanging_children = 0;
TEST(Hdf5Child, IsMadeAgainWhereItHangs) {
  const Scratch scratch;
  Write(Dwell(100), scratch / "a.h5");
  const auto made = [] { hanging_children = std::max(0, hanging_children - 1); };
  const auto hang = [] {
    while (hanging_children > 0) pause();
  };
  ASSERT_EQ(pthread_atfork(nullptr, made, hang), 0);
  hanging_children = 2;
  EXPECT_EQ(Read(scratch / "a.h5").rows(), 100u);
  EXPECT_EQ(hanging_children, 0);
}

}  // namespace damaged_hdf5_test
}  // namespace abbe::recording
