#include "apps/parameters_json.h"

#include <string>

namespace abbe::apps {

using nlohmann::ordered_json;

ordered_json ParametersJson(const estimation::Result& fit) {
  ordered_json parameters = ordered_json::array();
  for (const auto& block : fit.blocks) {
    for (std::size_t i = 0; i < block.entries.size(); ++i) {
      const auto& entry = block.entries[i];
      const std::string name = block.FullName(i);
      parameters.push_back({{"name", name},
                            {"unit", block.unit.name},
                            {"value", entry.value / block.unit.si},
                            {"uncertainty", entry.uncertainty / block.unit.si},
                            {"nominal", entry.nominal / block.unit.si},
                            {"prior", entry.prior_sd / block.unit.si},
                            {"seen_by", estimation::Name(fit.Seen(name))}});
    }
  }
  return parameters;
}

}  // namespace abbe::apps
