#include "apps/instruments.h"

#include <utility>

namespace abbe::apps {

simulation::Instruments InstrumentsOf(const MachineFile& file) {
  const auto& setup = file.sweep_setup;
  return {setup.machine, setup.head, setup.target, setup.noise, file.linkage};
}

simulation::Instruments ReadInstruments(const std::filesystem::path& path) {
  const auto document = settings::Document::Read(path);
  if (document.Root().Has("devices")) return InstrumentsOf(ReadMachineFile(path));
  MachineAlone alone = ReadMachineAlone(document);
  return {std::move(alone.machine), std::nullopt, {}, {}, std::move(alone.linkage)};
}

}  // namespace abbe::apps
