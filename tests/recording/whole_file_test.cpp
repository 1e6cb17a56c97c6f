// What a result may be written over, and what is left when it cannot be written.
#include "recording/whole_file.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <thread>

#include "recording/recording_file.h"
#include "scratch.h"

namespace abbe::recording {
namespace whole_file_test {

class WholeFileTest : public testing::Test {
 protected:
  ~WholeFileTest() override { SetOverwriting({}); }

  void Write(std::string_view text, const std::filesystem::path& path) const {
    WriteWhole(text, path);
  }
  std::string RefusalToWrite(std::string_view text, const std::filesystem::path& path) const {
    const std::string before = Bytes(path);
    const std::string message = MessageOf<InputError>([&] { WriteWhole(text, path); });
    EXPECT_EQ(Bytes(path), before);
    ExpectNoPart();
    return message;
  }
  void ExpectNoPart() const {
    for (const auto& entry : std::filesystem::directory_iterator(scratch_.folder())) {
      EXPECT_EQ(entry.path().string().find(".part"), std::string::npos) << entry.path();
    }
  }

  const Scratch scratch_;
};

TEST_F(WholeFileTest, OverwritesItsOwnKind) {
  const auto path = scratch_ / "a.json";
  Write("{\"a\": 1}\n", path);
  chmod(path.c_str(), 0640);
  Write("{\"b\": 2}\n", path);
  EXPECT_EQ(Bytes(path), "{\"b\": 2}\n");
  struct stat status {};
  stat(path.c_str(), &status);
  EXPECT_EQ(status.st_mode & 0777, 0640u);
  ExpectNoPart();
}

TEST_F(WholeFileTest, RefusesWhatIsOfAnotherKind) {
  const std::string map = "# An error map: docs/map.md says what each key means.\nformat = 1\n";
  Put(scratch_ / "sweep.csv", "# abbe-recording = 1\n# kind = \"dwell\"\ntime_s\n0\n");
  Put(scratch_ / "mill.toml", "name = \"mill\"\n");
  Put(scratch_ / "map.toml", map);
  Put(scratch_ / "part.ngc", "G21 G90\nG1 X1\nM2\n");
  Put(scratch_ / "photo.png", std::string_view("\x89PNG\0\0", 6));
  ExpectHas(RefusalToWrite("{}\n", scratch_ / "sweep.csv"), "nothing recorded is overwritten");
  ExpectHas(RefusalToWrite("x_mm\n1\n", scratch_ / "sweep.csv"), "nothing recorded is overwritten");
  ExpectHas(RefusalToWrite("{}\n", scratch_ / "mill.toml"), "holds your settings");
  ExpectHas(RefusalToWrite("x,y\n", scratch_ / "mill.toml"), "holds your settings");
  ExpectHas(RefusalToWrite(map, scratch_ / "mill.toml"), "holds your settings");
  ExpectHas(RefusalToWrite("{}\n", scratch_ / "map.toml"), "holds \"An error map\"");
  ExpectHas(RefusalToWrite("{}\n", scratch_ / "part.ngc"), "but JSON would be written");
  ExpectHas(RefusalToWrite(map, scratch_ / "photo.png"), "holds a binary file");
  Write(map + "more\n", scratch_ / "map.toml");
  Put(scratch_ / "empty.toml", "");
  Write("{}\n", scratch_ / "empty.toml");
  SetOverwriting({{}, true});
  Write("{}\n", scratch_ / "sweep.csv");
  EXPECT_EQ(Bytes(scratch_ / "sweep.csv"), "{}\n");
}

TEST_F(WholeFileTest, RefusesARecordingOfEitherForm) {
  for (const char* name : {"a.csv", "a.h5"}) {
    const auto path = scratch_ / name;
    recording::Write(Dwell(3), path);
    ExpectHas(MessageOf<InputError>([&] { recording::Write(Dwell(5), path); }),
              "nothing recorded is overwritten");
    EXPECT_EQ(Read(path).rows(), 3u);
    SetOverwriting({{}, true});
    recording::Write(Dwell(5), path);
    EXPECT_EQ(Read(path).rows(), 5u);
    SetOverwriting({});
  }
}

TEST_F(WholeFileTest, KnowsAnInputByAnyName) {
  Put(scratch_ / "p.ngc", "G1 X1\n");
  std::filesystem::create_hard_link(scratch_ / "p.ngc", scratch_ / "hard.ngc");
  std::filesystem::create_symlink("p.ngc", scratch_ / "soft.ngc");
  SetOverwriting({{scratch_.folder() / "." / "p.ngc"}, false});
  for (const char* name : {"p.ngc", "hard.ngc", "soft.ngc"}) {
    ExpectHas(RefusalToWrite("G1 X2\n", scratch_ / name), "this command reads it");
  }
}

TEST_F(WholeFileTest, FollowsALinkAndLeavesIt) {
  std::filesystem::create_directory(scratch_ / "far");
  std::filesystem::create_symlink("far/a.txt", scratch_ / "near.txt");
  for (const char* text : {"one\n", "two\n"}) {
    Write(text, scratch_ / "near.txt");
    EXPECT_TRUE(std::filesystem::is_symlink(scratch_ / "near.txt"));
    EXPECT_EQ(Bytes(scratch_.folder() / "far/a.txt"), text);
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(scratch_ / "far"), {}), 1);
}

TEST_F(WholeFileTest, WritesIntoAPipe) {
  const auto path = scratch_ / "pipe";
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  std::string got;
  std::jthread reader([&] { got = Bytes(path); });
  Write("through\n", path);
  reader.join();
  EXPECT_EQ(got, "through\n");
  EXPECT_TRUE(std::filesystem::is_fifo(path));
  ExpectHas(MessageOf<InputError>([&] { recording::Write(Dwell(1), scratch_ / "none/a.csv"); }),
            "cannot be created");
}

TEST_F(WholeFileTest, WritesIntoADeviceAndLeavesIt) {
  // A null device of our own: never risk that of the computer.
  const auto path = scratch_ / "null";
  if (mknod(path.c_str(), S_IFCHR | 0600, (1 << 8) | 3) != 0) GTEST_SKIP() << "needs root";
  const int file = open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (file < 0) GTEST_SKIP() << "no devices in this folder";
  close(file);
  Write("{}\n", path);
  EXPECT_TRUE(std::filesystem::is_character_file(path));
  ExpectNoPart();
}

TEST_F(WholeFileTest, RefusesAFolderAndAPartInTheWay) {
  ExpectHas(MessageOf<InputError>([&] { Write("{}\n", scratch_.folder()); }), "is a folder");
  // Whoever guesses the name of the part cannot lead it elsewhere.
  Put(scratch_ / "mine", "precious\n");
  const auto part = scratch_ / ("a.json." + std::to_string(getpid()) + ".part");
  std::filesystem::create_symlink("mine", part);
  ExpectHas(MessageOf<InputError>([&] { Write("{}\n", scratch_ / "a.json"); }), "is in the way");
  EXPECT_EQ(Bytes(scratch_ / "mine"), "precious\n");
  std::filesystem::remove(part);
}

// The limit on the size of a file stands for a disk that is full.
TEST_F(WholeFileTest, LeavesTheOldFileAndNothingElseOnAFullDisk) {
  const auto path = scratch_ / "a.json";
  Write("{\"old\": 1}\n", path);
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit size{1000, 1000};
    setrlimit(RLIMIT_FSIZE, &size);
    try {
      WriteWhole("{" + std::string(100'000, ' ') + "}", path);
    } catch (const DeviceError& failure) {
      _exit(std::string(failure.what()).find("disk full") == std::string::npos ? 2 : 0);
    } catch (const std::exception&) {
      _exit(3);
    }
    _exit(1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(WIFEXITED(status) ? WEXITSTATUS(status) : -1, 0);
  EXPECT_EQ(Bytes(path), "{\"old\": 1}\n");
  ExpectNoPart();
}

}  // namespace whole_file_test
}  // namespace abbe::recording
