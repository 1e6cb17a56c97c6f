// A build without SOCI: everything that needs no store works, a store is refused.
#include "failure/failure.h"
#include "history/database.h"

namespace abbe::history {

class Database::Connection {};

Database::Database(const StoreAddress& address, Missing /*missing*/) {
  throw InputError(address.Shown() +
                   ": this abbe was built without a store for histories; install libsoci-dev, "
                   "libsqlite3-dev and libpq-dev, and build it again with -DABBE_HISTORY=ON");
}
Database::~Database() = default;
void Database::InTransaction(Intent /*intent*/, const std::function<void()>& /*work*/) {}
void Database::Run(const std::string& /*statement*/, const std::vector<Value>& /*values*/) {}
std::vector<Row> Database::Rows(const std::string& /*statement*/,
                                const std::vector<Value>& /*values*/) {
  return {};
}
void Database::RunAlone(const std::string& /*statement*/, const std::vector<Value>& /*values*/) {}
bool Database::IsFile() const { return false; }
const StoreAddress& Database::address() const {
  throw InputError("this abbe was built without a store for histories");
}

}  // namespace abbe::history
