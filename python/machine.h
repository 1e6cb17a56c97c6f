// A machine file as Python holds it.
#pragma once

#include <filesystem>

#include "recording/recording.h"
#include "simulation/instruments.h"

namespace abbe::python {

struct MachineFile {
  std::filesystem::path path;
  simulation::Instruments instruments;

  const machine::Machine& machine() const { return instruments.machine; }
  // InputError when it names another machine.
  void RefuseOther(const recording::Recording& recording) const;
};

}  // namespace abbe::python
