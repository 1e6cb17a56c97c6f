#include "apps/result_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "failure/failure.h"

namespace abbe::apps {

void WriteText(const std::string& text, const std::filesystem::path& path) {
  std::error_code error;
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), error);
  const std::filesystem::path unfinished = path.string() + ".part";
  std::ofstream file(unfinished);
  file << text;
  file.close();
  if (!file) {
    throw InputError(
        fmt::format("{}: cannot be written: {}; choose another place with --out or --json",
                    path.string(), std::strerror(errno)));
  }
  std::filesystem::rename(unfinished, path);
}

void WriteResult(const nlohmann::ordered_json& result, const std::filesystem::path& path) {
  WriteText(result.dump(1) + '\n', path);
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
  } catch (const nlohmann::json::out_of_range& failure) {
    throw InputError(fmt::format("{}: holds a number that fits no double; write it anew ({})",
                                 path.string(), failure.what()));
  }
}

}  // namespace abbe::apps
