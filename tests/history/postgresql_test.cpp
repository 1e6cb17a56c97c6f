// A store on a real PostgreSQL server, which the test starts.
#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "../folders.h"
#include "schema_contract.h"
#include "store_contract.h"

namespace abbe::history {
namespace postgresql_test {

constexpr int kNotInstalled = 77;

class Server {
 public:
  Server() {
    const std::unique_ptr<FILE, int (*)(FILE*)> output(popen(Command("start").c_str(), "r"),
                                                       [](FILE*) { return 0; });
    std::array<char, 512> line{};
    if (std::fgets(line.data(), line.size(), output.get()) != nullptr) {
      address_ = std::string(line.data());
      address_.erase(address_.find('\n'));
    }
    exit_code_ = WEXITSTATUS(pclose(output.get()));
  }
  ~Server() {
    if (exit_code_ == 0) Run("stop", "fast");
  }
  bool installed() const { return exit_code_ != kNotInstalled; }
  const std::string& address() const { return address_; }
  // A database of its own.
  StoreAddress Database(const std::string& name) const {
    history::Database admin({.file = {}, .server = address_}, history::Database::Missing::kMake);
    admin.RunAlone("create database " + name);
    std::string address = address_;
    address.replace(address.find("/postgres?"), 10, "/" + name + "?");
    return {.file = {}, .server = address};
  }
  void Run(const std::string& action, const std::string& mode = "") const {
    EXPECT_EQ(std::system((Command(action) + " " + mode).c_str()), 0) << action;
  }

 private:
  std::string Command(const std::string& action) const {
    return (SourceFolder() / "tests/history/postgresql_server").string() + " " + action + " " +
           (scratch_ / "server").string();
  }

  // Its folder is that of another user below this one.
  struct Open {
    explicit Open(const std::filesystem::path& folder) {
      std::filesystem::permissions(
          folder, std::filesystem::perms::others_exec | std::filesystem::perms::others_read,
          std::filesystem::perm_options::add);
    }
  };
  Scratch scratch_;
  Open open_{(scratch_ / "server").parent_path()};
  std::string address_;
  int exit_code_ = 0;
};

// One server for all, for it takes seconds to make.
TEST(PostgresqlStore, KeepsTheContract) {
  const Server server;
  if (!server.installed()) GTEST_SKIP() << "SKIPPED: PostgreSQL is not installed";
  ASSERT_FALSE(server.address().empty());
  KeepsTheContract(server.Database("contract"));

  ExpectHas(MigratesAnOlderOne(server.Database("older")), "schema abbe_version_1");
  LeavesTheOlderOneWhenAStepFails(server.Database("failing"));
  RefusesANewerOne(server.Database("newer"));

  // The server goes away and comes back: what was in is in, and the next campaign is taken.
  const StoreAddress address = server.Database("restarted");
  Store store(address, Store::Missing::kMake);
  const long long first =
      *store.Add(MadeCampaign("mill", kMade, {FullResult(kMade, "before")}), kMade).campaign;
  server.Run("stop", "fast");
  server.Run("again");
  EXPECT_EQ(store.Read(first).results.size(), 1U);
  server.Run("stop", "fast");
  server.Run("again");
  EXPECT_TRUE(
      store.Add(MadeCampaign("mill", kMade + 1, {FullResult(kMade + 1, "after")}), kMade).campaign);
  EXPECT_EQ(store.List("mill").size(), 2U);

  StoreAddress impatient = address;
  impatient.patience = std::chrono::seconds(2);
  Store hasty(impatient, Store::Missing::kRefuse);
  server.Run("stop", "fast");
  const std::string message = MessageOf<DeviceError>(
      [&] { hasty.Add(MadeCampaign("mill", kMade + 2, {FullResult(kMade + 2, "never")}), kMade); });
  ExpectHas(message, "the server does not answer");
  ExpectHas(message, "nothing of this step was stored");
  server.Run("again");
  EXPECT_EQ(store.List("mill").size(), 2U);
}

}  // namespace postgresql_test
}  // namespace abbe::history
