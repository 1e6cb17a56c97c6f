// A connection to SQLite or PostgreSQL that hides SOCI, whose headers only database.cpp includes.
//
//   Database database(address, Database::Missing::kMake);
//   database.InTransaction(Intent::kWrite, [&] {
//     database.Run("insert into machine (name) values (:name)", {Text(name)});
//   });
//
// Values reach the statements as bound parameters only; the text of a statement never contains one.
//
// Transactions. When InTransaction() returns, the work is on the disk; when it throws, none of it
// is in the store. It repeats the whole work when another writer was in the way, and when a server
// went away, with a new connection, for as long as the patience of its address.
//
// Failure: InputError for a file that is no SQLite database or cannot be opened; DeviceError when
// the store is locked by another program for longer, the disk is full, or a server does not
// answer. A build without SOCI (ABBE_HISTORY) throws InputError from the constructor.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "history/store_address.h"

namespace abbe::history {

// A typed value of a statement; empty: NULL.
using Value =
    std::variant<std::optional<long long>, std::optional<double>, std::optional<std::string>>;
inline Value Whole(std::optional<long long> value) { return value; }
inline Value Real(std::optional<double> value) { return value; }
inline Value Text(std::optional<std::string> value) { return value; }

// A row of an answer, read by position.
class Row {
 public:
  explicit Row(std::vector<Value> values) : values_(std::move(values)) {}

  long long WholeAt(std::size_t column) const;
  std::optional<double> RealAt(std::size_t column) const;
  std::string TextAt(std::size_t column) const;  // NULL: empty

 private:
  std::vector<Value> values_;
};

enum class Intent { kRead, kWrite };

class Database {
 public:
  enum class Missing { kRefuse, kMake };

  Database(const StoreAddress& address, Missing missing);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  void InTransaction(Intent intent, const std::function<void()>& work);

  // Within a transaction. `statement` has its parameters as :name, in the order of `values`.
  void Run(const std::string& statement, const std::vector<Value>& values = {});
  std::vector<Row> Rows(const std::string& statement, const std::vector<Value>& values = {});

  // Outside of a transaction, as VACUUM requires.
  void RunAlone(const std::string& statement, const std::vector<Value>& values = {});

  bool IsFile() const;
  const StoreAddress& address() const;

 private:
  class Connection;
  std::unique_ptr<Connection> connection_;
};

}  // namespace abbe::history
