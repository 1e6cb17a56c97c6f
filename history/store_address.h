// Where a history is kept: a file for SQLite, or a PostgreSQL server.
//
//   const StoreAddress address = ReadAddress("postgresql://abbe@plant-server/history");
//   const std::string shown = address.Shown();      // without the password
//
// Failure: InputError for a scheme other than postgresql or postgres, and where no folder for the
// default is known.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>

namespace abbe::history {

struct StoreAddress {
  std::filesystem::path file;  // of SQLite; empty: a server
  std::string server{};        // "postgresql://..."
  // How long a step waits for another writer, or for a server that went away.
  std::chrono::seconds patience{30};

  bool IsFile() const { return !file.empty(); }
  std::string Shown() const;  // for messages: a password in it becomes ***
};

// The address that a user typed.
StoreAddress ReadAddress(const std::string& typed);

// history.db in the folder abbe of the user's data: $XDG_DATA_HOME, else ~/.local/share.
// Source: XDG Base Directory Specification 0.8.
StoreAddress DefaultAddress();

}  // namespace abbe::history
