#include "machine/configurations.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>
#include <vector>

#include "failure/failure.h"
#include "settings/nearest_word.h"

namespace abbe::machine {

Chain ChainOf(std::string_view chain) {
  if (chain.starts_with('[')) return Chain::Parse(chain);
  std::vector<std::string> names;
  for (const Configuration& known : kConfigurations) {
    if (known.name == chain) return Chain::Parse(known.chain);
    names.emplace_back(known.name);
  }
  throw InputError(
      fmt::format("\"{}\" is not a machine configuration; did you mean \"{}\"? Known are {}; or "
                  "write the chain in brackets, as \"[w X Y b Z t]\"",
                  chain, settings::NearestWord(chain, names), fmt::join(names, ", ")));
}

}  // namespace abbe::machine
