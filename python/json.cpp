#include <nlohmann/json.hpp>

#include "bindings.h"

namespace abbe::python {

py::object ToPython(const nlohmann::ordered_json& json) {
  if (json.is_object()) {
    py::dict dict;
    for (const auto& [key, value] : json.items()) dict[py::str(key)] = ToPython(value);
    return dict;
  }
  if (json.is_array()) {
    py::list list;
    for (const auto& value : json) list.append(ToPython(value));
    return list;
  }
  if (json.is_string()) return py::str(json.get_ref<const std::string&>());
  if (json.is_boolean()) return py::bool_(json.get<bool>());
  if (json.is_number_integer()) return py::int_(json.get<long long>());
  if (json.is_number()) return py::float_(json.get<double>());
  return py::none();
}

}  // namespace abbe::python
