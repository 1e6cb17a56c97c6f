#include "apps/machine_file.h"

#include <fmt/format.h>

#include "apps/protocol.h"
#include "certificate/administration.h"
#include "history/limits.h"
#include "investigate/cost.h"
#include "machine/drift.h"
#include "rig/rig_settings.h"

namespace abbe::apps {

const hal::SweepPlan& MachineFile::SweepPlanOf(char axis) const {
  const auto plan = sweep_plans.find(axis);
  if (plan == sweep_plans.end()) {
    throw InputError(
        fmt::format("{}: has no table [sweep.{}]; add one with first_mm, last_mm and step_mm",
                    document.name(), axis));
  }
  return plan->second;
}

void MachineFile::RequireDevices() const {
  if (!devices.devices.empty()) return;
  throw InputError(
      fmt::format("{}: has no table [devices.NAME]; describe the devices to read (docs/devices.md)",
                  document.name()));
}

const relm::LinkageSettings& MachineFile::Linkage() const {
  if (linkage) return *linkage;
  throw InputError(fmt::format(
      "{}: has no table [linkage]; add one with the form and the lengths of the linkage",
      document.name()));
}

MachineFile ReadMachineFile(const std::filesystem::path& path) {
  return ReadMachineFile(settings::Document::Read(path));
}

MachineFile ReadMachineFile(const settings::Document& document) {
  const settings::Table root = document.Root();
  MachineFile file{document, probes::ReadSweepSetup(root),   {}, {},
                   {},       probes::ReadAlignSettings(root)};
  if (root.Has("devices")) file.devices = hal::ReadDevices(root.Child("devices"));
  const settings::Table sweep = root.Child("sweep");
  for (const char axis : {'X', 'Y', 'Z'}) {
    const std::string name(1, axis);
    if (!sweep.Has(name)) continue;
    if (file.sweep_setup.machine.chain.Text().find(axis) == std::string::npos) {
      throw sweep.Error(name,
                        fmt::format("is not an axis of the chain {}; add it there, or remove the "
                                    "table",
                                    file.sweep_setup.machine.chain.Text()));
    }
    file.sweep_plans[axis] = hal::ReadSweepPlan(sweep, axis);
  }
  if (root.Has("linkage")) file.linkage = relm::ReadLinkageSettings(root);
  rig::ReadRigSettings(root);
  ReadProtocol(root);
  history::ReadLimits(root);
  if (root.Has("certificate")) certificate::ReadAdministration(root);
  machine::ReadDrift(root);
  investigate::CheckCosts(root);
  root.RefuseUnknown();
  return file;
}

machine::Machine ReadMachineOf(const std::filesystem::path& path) {
  const settings::Document document = settings::Document::Read(path);
  if (document.Root().Has("devices")) return ReadMachineFile(document).sweep_setup.machine;
  machine::Machine machine = machine::ReadMachine(document.Root());
  ReadProtocol(document.Root());
  history::ReadLimits(document.Root());
  if (document.Root().Has("certificate")) certificate::ReadAdministration(document.Root());
  machine::ReadDrift(document.Root());
  investigate::CheckCosts(document.Root());
  document.Root().RefuseUnknown();
  return machine;
}

MachineAlone ReadMachineAlone(const settings::Document& document) {
  const settings::Table root = document.Root();
  const bool bare = !root.Has("chain") && !root.Has("axis");
  MachineAlone alone{bare ? machine::ReadMachineWithoutAxes(root) : machine::ReadMachine(root), {}};
  if (root.Has("linkage")) alone.linkage = relm::ReadLinkageSettings(root);
  ReadProtocol(root);
  history::ReadLimits(root);
  if (root.Has("certificate")) certificate::ReadAdministration(root);
  machine::ReadDrift(root);
  investigate::CheckCosts(root);
  root.RefuseUnknown();
  return alone;
}

}  // namespace abbe::apps
