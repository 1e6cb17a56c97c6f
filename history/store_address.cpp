#include "history/store_address.h"

#include <fmt/format.h>

#include <cstdlib>

#include "failure/failure.h"

namespace abbe::history {
namespace {

std::string Variable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

}  // namespace

std::string StoreAddress::Shown() const {
  if (IsFile()) return file.string();
  const auto end = server.find('@');
  const auto user = server.find("://") + 3;
  const auto colon = server.find(':', user);
  std::string shown = server;
  if (end != std::string::npos && colon != std::string::npos && colon < end) {
    shown.replace(colon + 1, end - colon - 1, "***");
  }
  const auto password = shown.find("password=");
  if (password != std::string::npos) {
    const auto begin = password + 9;
    shown.replace(begin, std::min(shown.find('&', begin), shown.size()) - begin, "***");
  }
  return shown;
}

StoreAddress ReadAddress(const std::string& typed) {
  const auto scheme = typed.find("://");
  if (scheme == std::string::npos) return {.file = typed};
  if (typed.starts_with("postgresql://") || typed.starts_with("postgres://"))
    return {.file = {}, .server = typed};
  throw InputError(
      fmt::format("--store {}://: no such kind of store; name a file, or a server as "
                  "postgresql://user@host/database",
                  typed.substr(0, scheme)));
}

StoreAddress DefaultAddress() {
  std::filesystem::path data = Variable("XDG_DATA_HOME");
  if (data.is_absolute()) return {.file = data / "abbe" / "history.db"};
  const std::filesystem::path home = Variable("HOME");
  if (home.empty()) {
    throw InputError("neither XDG_DATA_HOME nor HOME is set; name the store with --store FILE");
  }
  return {.file = home / ".local" / "share" / "abbe" / "history.db"};
}

}  // namespace abbe::history
