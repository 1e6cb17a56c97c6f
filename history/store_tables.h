// The tables of the history: adding and forgetting campaigns, and what a query asks first.
//
// All writing is here, each campaign in one transaction; the queries are in store.cpp. Units,
// failure: history/store.h. For use within history/ only.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "history/database.h"
#include "history/store.h"

namespace abbe::history {

class Store::Tables {
 public:
  Tables(const StoreAddress& address, Missing missing);

  const std::vector<std::string>& notes() const { return notes_; }

  // All of them or none.
  std::vector<Added> Add(std::span<const Campaign> campaigns, double now);
  // With all that belongs to it.
  void Forget(long long campaign);

  // Sees the tables as they were at its beginning.
  template <typename Use>
  void Reading(const Use& use) {
    database_.InTransaction(Intent::kRead, use);
  }
  std::vector<Row> Rows(const std::string& statement, const std::vector<Value>& values = {}) {
    return database_.Rows(statement, values);
  }

  // InputError unless there is such a campaign.
  void Require(long long campaign);
  // InputError unless there is such a machine, or none is asked for.
  void RequireMachine(const std::string& machine);

 private:
  Added AddOne(const Campaign& campaign, double now);
  long long Insert(const std::string& statement, const std::vector<Value>& values);
  long long MachineOf(const Campaign& campaign);
  std::optional<long long> FileOf(const Campaign& campaign);
  long long InsertCampaign(const Campaign& campaign, long long machine, double now);
  void InsertFiles(const Campaign& campaign, long long id);
  void InsertResult(const ResultFile& result, long long machine, long long campaign);

  Database database_;
  std::vector<std::string> notes_;
};

}  // namespace abbe::history
