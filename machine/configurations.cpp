#include "machine/configurations.h"

#include <fmt/format.h>

#include <string>

#include "failure/failure.h"

namespace abbe::machine {

Chain ChainOf(std::string_view configuration) {
  std::string names;
  for (const Configuration& known : kConfigurations) {
    if (known.name == configuration) return Chain::Parse(known.chain);
    names += fmt::format("{}{}", names.empty() ? "" : ", ", known.name);
  }
  throw InputError(
      fmt::format("unknown machine configuration \"{}\"; choose one of {}", configuration, names));
}

}  // namespace abbe::machine
