// A machine file as Python holds it: its text and what it describes.
#pragma once

#include <string>
#include <vector>

#include "recording/recording.h"
#include "settings/document.h"
#include "settings/toml_keys.h"
#include "simulation/instruments.h"
#include "simulation/run_source.h"

namespace abbe::python {

struct MachineFile {
  settings::TomlKeys keys;
  simulation::Instruments instruments;

  // InputError with the name of the text, line and key.
  explicit MachineFile(settings::TomlKeys of);

  const std::string& name() const { return keys.name(); }
  const machine::Machine& machine() const { return instruments.machine; }
  settings::Document document() const { return settings::Document::Parse(keys.text(), name()); }
  // InputError when it names another machine.
  void RefuseOther(const recording::Recording& recording) const;
  // For a map. InputError when one names another machine or they do not belong together.
  std::vector<simulation::RunSource> SourcesOf(
      const std::vector<recording::Recording>& recordings) const;
};

}  // namespace abbe::python
