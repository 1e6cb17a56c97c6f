#include "history/store.h"

#include "schema_contract.h"
#include "store_contract.h"

namespace abbe::history {
namespace store_test {

StoreAddress FileIn(const Scratch& scratch) { return {.file = scratch / "history.db"}; }

TEST(Store, KeepsTheContractInAFile) {
  const Scratch scratch;
  KeepsTheContract(FileIn(scratch));
}

TEST(Store, AnOlderFileIsMigratedAfterACopy) {
  const Scratch scratch;
  const std::string note = MigratesAnOlderOne(FileIn(scratch));
  ExpectHas(note, "history.db.version-1");
  Database copy({.file = scratch / "history.db.version-1"}, Database::Missing::kRefuse);
  EXPECT_EQ(VersionIn(copy), 1);
  copy.InTransaction(Intent::kRead, [&] {
    EXPECT_EQ(copy.Rows("select name from machine").front().TextAt(0), "old");
  });
}

TEST(Store, AStepThatFailsLeavesTheOlderFile) {
  const Scratch scratch;
  LeavesTheOlderOneWhenAStepFails(FileIn(scratch));
}

TEST(Store, ANewerFileIsRefusedAndStays) {
  const Scratch scratch;
  RefusesANewerOne(FileIn(scratch));
}

TEST(Store, WhatIsNoStoreIsRefusedAndStays) {
  const Scratch scratch;
  const auto refusal = [&](const std::filesystem::path& path) {
    return MessageOf<InputError>([&] { Store({.file = path}, Store::Missing::kMake); });
  };
  std::ofstream(scratch / "letter.txt") << "Dear reader";
  ExpectHas(refusal(scratch / "letter.txt"), "is not a history of abbe (no SQLite database)");
  EXPECT_EQ(Bytes(scratch / "letter.txt"), "Dear reader");
  {
    Database other({.file = scratch / "other.db"}, Database::Missing::kMake);
    other.InTransaction(Intent::kWrite, [&] { other.Run("create table songs (id integer)"); });
  }
  ExpectHas(refusal(scratch / "other.db"), "it has the table \"songs\" of something else");
  ExpectHas(refusal(scratch / ""), "is a folder");
  ExpectHas(
      MessageOf<InputError>([&] { Store({.file = scratch / "none.db"}, Store::Missing::kRefuse); }),
      "there is no history yet");
  EXPECT_FALSE(std::filesystem::exists(scratch / "none.db"));
}

TEST(Store, ADamagedFileIsSaid) {
  const Scratch scratch;
  { Store(FileIn(scratch), Store::Missing::kMake); }
  std::string bytes = Bytes(scratch / "history.db");
  std::fill(bytes.begin() + 100, bytes.end(), 'x');
  std::ofstream(scratch / "history.db", std::ios::binary) << bytes;
  std::filesystem::remove(scratch / "history.db-wal");
  ExpectHas(MessageOf<InputError>([&] { Store(FileIn(scratch), Store::Missing::kRefuse); }),
            "is damaged");
}

// The one that holds it locked is not waited for any longer than the patience of the other.
TEST(Store, ALockedFileIsWaitedForAndSaid) {
  const Scratch scratch;
  StoreAddress hasty = FileIn(scratch);
  hasty.patience = std::chrono::seconds(2);
  Store store(hasty, Store::Missing::kMake);
  Database holder(FileIn(scratch), Database::Missing::kRefuse);
  holder.InTransaction(Intent::kWrite, [&] {
    const auto campaign = MadeCampaign("mill", kMade, {FullResult(kMade, "locked out")});
    ExpectHas(MessageOf<DeviceError>([&] { store.Add(campaign, kMade); }),
              "another program holds the store locked");
  });
  const auto campaign = MadeCampaign("mill", kMade, {FullResult(kMade, "locked out")});
  EXPECT_TRUE(store.Add(campaign, kMade).campaign);
}

TEST(StoreAddress, HidesThePassword) {
  EXPECT_EQ(ReadAddress("postgresql://abbe:secret@host/db").Shown(),
            "postgresql://abbe:***@host/db");
  EXPECT_EQ(ReadAddress("postgresql://host/db?password=secret&x=1").Shown(),
            "postgresql://host/db?password=***&x=1");
  EXPECT_EQ(ReadAddress("postgresql://abbe@host:5432/db").Shown(),
            "postgresql://abbe@host:5432/db");
  EXPECT_TRUE(ReadAddress("history.db").IsFile());
  ExpectHas(MessageOf<InputError>([] { ReadAddress("mysql://host/db"); }), "no such kind of store");
}

}  // namespace store_test
}  // namespace abbe::history
