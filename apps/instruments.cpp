#include "apps/instruments.h"

#include <utility>

namespace abbe::apps {

simulation::Instruments InstrumentsOf(const MachineFile& file) {
  const auto& setup = file.sweep_setup;
  return {setup.machine, setup.head, setup.target, setup.noise, file.linkage};
}

simulation::Instruments InstrumentsIn(const settings::Document& document) {
  if (document.Root().Has("devices")) return InstrumentsOf(ReadMachineFile(document));
  MachineAlone alone = ReadMachineAlone(document);
  return {std::move(alone.machine), std::nullopt, {}, {}, std::move(alone.linkage)};
}

simulation::Instruments ReadInstruments(const std::filesystem::path& path) {
  return InstrumentsIn(settings::Document::Read(path));
}

}  // namespace abbe::apps
