// An investigation that was interrupted goes on where it was, and decides by the recordings alone.
#include <gtest/gtest.h>

#include <stdexcept>

#include "failure/failure.h"
#include "tests/investigate/investigated_world.h"

namespace abbe {
namespace interruption_test {

using investigate::Journal;

constexpr std::uint64_t kSeed = 7;

// Has the head alone: what else could be measured is not weighed, which would take minutes.
class HeadRecorder : public WorldRecorder {
 public:
  using WorldRecorder::WorldRecorder;
  bool Records(const recording::Recording& path) const override {
    return path.Kind() == "sweep" && WorldRecorder::Records(path);
  }
};

// Dies as it begins to record the second run.
class Dying : public HeadRecorder {
 public:
  using HeadRecorder::HeadRecorder;
  std::optional<std::string> Record(const recording::Recording& path,
                                    const Journal& journal) override {
    if (recorded == 1) throw std::runtime_error("killed");
    return HeadRecorder::Record(path, journal);
  }
};

// Knows no world: hands out the recordings of another folder.
class Replay : public investigate::Recorder {
 public:
  Replay(std::filesystem::path folder, const WorldRecorder& records)
      : folder_(std::move(folder)), records_(records) {}
  bool Records(const recording::Recording& path) const override { return records_.Records(path); }
  std::optional<std::string> Record(const recording::Recording& path,
                                    const Journal& journal) override {
    const std::string name = std::to_string(journal.number()) + "_" + path.Kind() + ".h5";
    if (!std::filesystem::exists(folder_ / name)) return {};
    std::filesystem::copy_file(folder_ / name, journal.folder() / name);
    return name;
  }

 private:
  std::filesystem::path folder_;
  const WorldRecorder& records_;
};

class Interruption : public ::testing::Test {
 protected:
  Interruption() { machine_.subject().budget = 31.0; }  // two runs

  HeadRecorder World() { return {machine_.rig(), kSeed, machine_.Hidden(kSeed, {})}; }

  InvestigatedMachine machine_;
};

TEST_F(Interruption, GoesOnWhereItWas) {
  const auto whole = EmptyFolder("whole"), broken = EmptyFolder("broken");
  HeadRecorder world = World();
  Journal at_once = Journal::In(whole, AboutDemo());
  investigate::Investigate(machine_.subject(), world, at_once);
  ASSERT_GE(at_once.steps(), 2u);

  Dying dying(machine_.rig(), kSeed, machine_.Hidden(kSeed, {}));
  Journal first = Journal::In(broken, AboutDemo());
  EXPECT_THROW(investigate::Investigate(machine_.subject(), dying, first), std::runtime_error);
  HeadRecorder again = World();
  Journal second = Journal::In(broken, AboutDemo());
  EXPECT_TRUE(second.IsWaiting());
  investigate::Investigate(machine_.subject(), again, second);
  EXPECT_EQ(second.data(), at_once.data());
  EXPECT_EQ(again.recorded + 1, world.recorded);  // the first run was kept

  // Nobody knows the world here: the same recordings, the same decisions.
  const auto replayed = EmptyFolder("replayed");
  Replay replay(whole, world);
  Journal third = Journal::In(replayed, AboutDemo());
  investigate::Investigate(machine_.subject(), replay, third);
  EXPECT_EQ(third.data(), at_once.data());
  for (const auto& folder : {whole, broken, replayed}) std::filesystem::remove_all(folder);
}

TEST_F(Interruption, RefusesTheFolderOfAnotherMachine) {
  const auto folder = EmptyFolder("other");
  Journal::In(folder, AboutDemo());
  investigate::About other = AboutDemo();
  other.machine = "lathe";
  EXPECT_THROW(Journal::In(folder, other), InputError);
  other = AboutDemo();
  other.recorder = "devices";
  EXPECT_THROW(Journal::In(folder, other), InputError);
  std::filesystem::remove_all(folder);
}

}  // namespace interruption_test
}  // namespace abbe
