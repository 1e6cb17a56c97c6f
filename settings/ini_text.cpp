#include "settings/ini_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "failure/failure.h"
#include "settings/words.h"

namespace abbe::settings {
namespace {

std::string_view WithoutComment(std::string_view line) {
  for (std::size_t at = line.find_first_of("#;"); at != std::string_view::npos;
       at = line.find_first_of("#;", at + 1)) {
    if (at == 0 || line[at - 1] == ' ' || line[at - 1] == '\t') return line.substr(0, at);
  }
  return line;
}

}  // namespace

std::map<std::string, std::string> ParseIni(std::string_view text, const std::string& file) {
  std::map<std::string, std::string> values;
  std::string section;
  bool has_section = false, goes_on = false;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = Trimmed(WithoutComment(text.substr(0, end)));
    text.remove_prefix(std::min(end + 1, text.size()));
    const bool continues = std::exchange(goes_on, line.ends_with('\\'));
    if (line.empty() || continues) continue;
    const std::size_t split = line.find(line[0] == '[' ? ']' : '=');
    if (split == std::string_view::npos || (line[0] != '[' && !has_section)) {
      throw InputError(
          fmt::format("{}:{}: neither [SECTION] nor KEY = VALUE in a section; is it an "
                      "INI file of LinuxCNC?",
                      file, number));
    }
    if (line[0] == '[') {
      section = line.substr(1, split - 1);
      has_section = true;
      continue;
    }
    values.try_emplace(fmt::format("{}.{}", section, Trimmed(line.substr(0, split))),
                       Trimmed(line.substr(split + 1)));
  }
  return values;
}

}  // namespace abbe::settings
