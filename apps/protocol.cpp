#include "apps/protocol.h"

#include <fmt/format.h>

#include "settings/toml_text.h"

namespace abbe::apps {

Protocol ReadProtocol(const settings::Table& root) {
  const settings::Table table = root.Child("protocol");
  Protocol protocol{table.Text("operator", ""), table.Text("serial", "")};
  table.RefuseUnknown();
  return protocol;
}

std::string ProtocolText(const settings::Document& machine, const std::string& operator_name) {
  Protocol protocol = ReadProtocol(machine.Root());
  if (!operator_name.empty()) protocol.operator_name = operator_name;
  std::string text;
  for (const auto& [key, value] :
       {std::pair{"operator", protocol.operator_name}, std::pair{"serial", protocol.serial}}) {
    if (!value.empty()) text += fmt::format("{} = {}\n", key, settings::Quoted(value));
  }
  return text.empty() ? text : "[protocol]\n" + text;
}

void AddProtocol(const recording::Recording& recording, nlohmann::ordered_json& result) {
  for (const char* const key : {"operator", "serial"}) {
    const auto text = recording.HeaderText(fmt::format("protocol.{}", key));
    if (text && !text->empty() && !result["protocol"].contains(key))
      result["protocol"][key] = *text;
  }
  if (recording.IsSimulated()) result["simulated"] = true;
}

}  // namespace abbe::apps
