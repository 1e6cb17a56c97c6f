#include "simulation/causes/registry.h"

#include <fmt/format.h>

#include "failure/failure.h"
#include "settings/nearest_word.h"

namespace abbe::simulation {

const std::vector<Cause>& Causes() {
#define ABBE_CALL_CAUSE(name) name(),
  static const std::vector<Cause> causes{ABBE_CAUSES(ABBE_CALL_CAUSE)};
#undef ABBE_CALL_CAUSE
  return causes;
}

const Cause& CauseNamed(const std::string& id) {
  std::vector<std::string> names;
  for (const Cause& cause : Causes()) {
    if (cause.id == id) return cause;
    names.push_back(cause.id);
  }
  throw InputError(fmt::format("no cause \"{}\" is known; the nearest is \"{}\"", id,
                               settings::NearestWord(id, names)));
}

}  // namespace abbe::simulation
