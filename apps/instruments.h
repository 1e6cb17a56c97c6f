// The machine file as a simulation takes it.
#pragma once

#include <filesystem>

#include "apps/machine_file.h"
#include "simulation/instruments.h"

namespace abbe::apps {

simulation::Instruments InstrumentsOf(const MachineFile& file);

// Also of a file without [devices], which is enough for runs with a reference, an arm or a shaft.
simulation::Instruments InstrumentsIn(const settings::Document& document);
simulation::Instruments ReadInstruments(const std::filesystem::path& path);

}  // namespace abbe::apps
