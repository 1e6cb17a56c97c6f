// The machine file as a whole: every folder reads its own table, and a key that nobody knows is
// refused, whatever the command needs of the file.
#pragma once

#include <filesystem>
#include <map>
#include <optional>

#include "hal/device_settings.h"
#include "hal/sweep_plan.h"
#include "probes/sweep_reduction.h"
#include "relm/linkage_settings.h"
#include "settings/document.h"

namespace abbe::apps {

struct MachineFile {
  settings::Document document;
  probes::SweepSetup sweep_setup;
  hal::DevicesSettings devices;                  // none where the file has no table [devices]
  std::map<char, hal::SweepPlan> sweep_plans;    // by axis, of the tables [sweep.X] that are there
  std::optional<relm::LinkageSettings> linkage;  // of the table [linkage], if it is there

  // InputError naming the file when it has no [sweep.AXIS].
  const hal::SweepPlan& SweepPlanOf(char axis) const;
  // InputError naming the file when it has no device.
  void RequireDevices() const;
  // InputError naming the file when it has no [linkage].
  const relm::LinkageSettings& Linkage() const;
};

// InputError with file, line and key.
MachineFile ReadMachineFile(const std::filesystem::path& path);

// The machine alone: its file may be one without [devices], which then holds nothing but the
// machine.
machine::Machine ReadMachineOf(const std::filesystem::path& path);

// A machine as far as its file describes it without [devices], which may be missing: its axes, a
// linkage, a linkage alone (an arm before an instrument) or a name alone (a shaft), which need no
// `chain` and no [axis].
struct MachineAlone {
  machine::Machine machine;
  std::optional<relm::LinkageSettings> linkage;
};
MachineAlone ReadMachineAlone(const settings::Document& document);

}  // namespace abbe::apps
