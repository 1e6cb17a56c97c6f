#include "apps/rig_option.h"

#include <fmt/format.h>

#include <charconv>
#include <sstream>

#include "failure/failure.h"

namespace abbe::apps {

RigOption ParseRigOption(const std::string& text) {
  RigOption option;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t equals = part.find('=');
    const std::string key = part.substr(0, equals);
    const std::string value = equals == std::string::npos ? "" : part.substr(equals + 1);
    const char* end = value.data() + value.size();
    if (key == "seed" && std::from_chars(value.data(), end, option.seed).ptr == end &&
        !value.empty()) {
      continue;
    }
    if (key != "hide" || value.empty()) {
      throw InputError(
          fmt::format("--rig {}: \"{}\" is neither seed=NUMBER nor hide=EFFECT; write for example "
                      "seed=7,hide=backlash:object=X",
                      text, part));
    }
    option.hide.push_back(value);
  }
  return option;
}

}  // namespace abbe::apps
