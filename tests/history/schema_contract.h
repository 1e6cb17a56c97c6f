// How a store comes from an older version to the newest, of whichever kind.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "history/database.h"
#include "history/schema.h"
#include "store_contract.h"

namespace abbe::history {

// A store of version 1 with one machine in it.
inline void MakeFirstVersion(const StoreAddress& address) {
  Database database(address, Database::Missing::kMake);
  EXPECT_TRUE(BringUpToDate(database, Migrations().first(1)).empty());
  database.InTransaction(Intent::kWrite, [&] {
    database.Run("insert into machine (name, serial) values (:name, :serial)",
                 {Text("old"), Text("1")});
  });
}

inline long long VersionIn(Database& database) {
  long long version = 0;
  database.InTransaction(Intent::kRead, [&] {
    version = database.Rows("select version from abbe_history").front().WholeAt(0);
  });
  return version;
}

inline std::string MigratesAnOlderOne(const StoreAddress& address) {
  MakeFirstVersion(address);
  const Store store(address, Store::Missing::kRefuse);
  EXPECT_EQ(store.notes().size(), 1U);
  EXPECT_EQ(store.Machines(), std::vector<std::string>{"old"});
  const Store again(address, Store::Missing::kRefuse);
  EXPECT_TRUE(again.notes().empty());
  return store.notes().empty() ? "" : store.notes().front();
}

inline void LeavesTheOlderOneWhenAStepFails(const StoreAddress& address) {
  MakeFirstVersion(address);
  Database database(address, Database::Missing::kRefuse);
  const std::vector<Migration> steps{
      Migrations()[0], {"create table later (id {whole})", "create table machine (id {whole})"}};
  EXPECT_THROW(BringUpToDate(database, steps), Failure);
  EXPECT_EQ(VersionIn(database), 1);
  database.InTransaction(Intent::kRead, [&] {
    EXPECT_THROW(database.Rows("select id from later"), std::runtime_error);
  });
}

inline void RefusesANewerOne(const StoreAddress& address) {
  {
    Database database(address, Database::Missing::kMake);
    std::vector<Migration> steps(Migrations().begin(), Migrations().end());
    steps.push_back({"create table later (id {whole})"});
    BringUpToDate(database, steps);
  }
  const std::string message = MessageOf<InputError>([&] { Store(address, Store::Missing::kMake); });
  ExpectHas(message, "is of version 3, this abbe knows 2 at most");
}

}  // namespace abbe::history
