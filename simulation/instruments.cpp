#include "simulation/instruments.h"

#include <fmt/format.h>

#include <algorithm>

#include "failure/failure.h"

namespace abbe::simulation {
namespace {

template <typename Settings>
const Settings& Require(const std::optional<Settings>& settings, const std::string& recording,
                        const char* table) {
  if (settings) return *settings;
  throw InputError(fmt::format(
      "{}: the machine file has no table [{}]; add it or leave the run out", recording, table));
}

}  // namespace

bool Instruments::HasAxes() const {
  return std::ranges::any_of(machine.travels,
                             [](const auto& travel) { return travel.last > travel.first; });
}

const probes::HeadSettings& Instruments::HeadFor(const std::string& recording) const {
  return Require(head, recording, "head");
}

const relm::LinkageSettings& Instruments::LinkageFor(const std::string& recording) const {
  return Require(linkage, recording, "linkage");
}

}  // namespace abbe::simulation
