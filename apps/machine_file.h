// The whole machine file: every folder reads its own table, and an unknown key is refused
// even if the command does not need it.
#pragma once

#include <filesystem>
#include <map>
#include <optional>

#include "hal/device_settings.h"
#include "hal/sweep_plan.h"
#include "probes/align_settings.h"
#include "probes/sweep_reduction.h"
#include "relm/linkage_settings.h"
#include "settings/document.h"

namespace abbe::apps {

struct MachineFile {
  settings::Document document;
  probes::SweepSetup sweep_setup;
  hal::DevicesSettings devices;                  // none if the file has no table [devices]
  std::map<char, hal::SweepPlan> sweep_plans;    // by axis, one for each table [sweep.X]
  std::optional<relm::LinkageSettings> linkage;  // of the table [linkage], if any
  probes::AlignSettings align;                   // of the table [align]

  // InputError naming the file when it has no [sweep.AXIS].
  const hal::SweepPlan& SweepPlanOf(char axis) const;
  // InputError naming the file when it has no device.
  void RequireDevices() const;
  // InputError naming the file when it has no [linkage].
  const relm::LinkageSettings& Linkage() const;
};

// InputError with file, line and key.
MachineFile ReadMachineFile(const std::filesystem::path& path);
MachineFile ReadMachineFile(const settings::Document& document);

// Reads the machine only. Its file may lack [devices]; it then contains nothing but the machine.
machine::Machine ReadMachineOf(const std::filesystem::path& path);

// A machine from a file that needs no [devices]: axes with or without a linkage,
// only a linkage (an arm with a reference instrument), or only a name (a shaft). The
// last two need no `chain` and no [axis].
struct MachineAlone {
  machine::Machine machine;
  std::optional<relm::LinkageSettings> linkage;
};
MachineAlone ReadMachineAlone(const settings::Document& document);

}  // namespace abbe::apps
