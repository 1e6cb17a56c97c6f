#include "apps/result_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "failure/failure.h"
#include "recording/whole_file.h"

namespace abbe::apps {

void WriteText(const std::string& text, const std::filesystem::path& path) {
  recording::WriteWhole(text, path);
}

void WriteResult(const nlohmann::ordered_json& result, const std::filesystem::path& path) {
  // JSON is UTF-8: invalid bytes, as in a file name, are replaced.
  WriteText(result.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + '\n', path);
}

nlohmann::ordered_json ReadResult(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) {
    throw InputError(
        fmt::format("{}: cannot be read: {}; check the path", path.string(), std::strerror(errno)));
  }
  try {
    return nlohmann::ordered_json::parse(file);
  } catch (const nlohmann::json::parse_error& failure) {
    throw InputError(fmt::format("{}: not valid JSON at byte {}", path.string(), failure.byte));
  } catch (const nlohmann::json::out_of_range&) {
    throw InputError(fmt::format(
        "{}: contains a number beyond 1e308; correct it or write the file again", path.string()));
  }
}

}  // namespace abbe::apps
