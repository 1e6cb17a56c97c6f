#include "apps/readiness.h"

#include <fmt/format.h>

#include "apps/machine_file.h"

namespace abbe::apps {
namespace {

// Reads the file as a command would, so that a wrong key is refused with its line.
void ReadAsCommandsDo(const settings::Document& machine_file) {
  const settings::Table root = machine_file.Root();
  if (root.Has("devices") || root.Has("head")) {
    ReadMachineFile(machine_file);
  } else {
    ReadMachineAlone(machine_file);
  }
}

// "YZ": the machine has X alone.
std::string AbsentAxes(const settings::Table& root) {
  std::string absent;
  for (const char axis : std::string("XYZ")) {
    if (!root.Child("axis").Has(std::string(1, axis))) absent += axis;
  }
  return absent;
}

}  // namespace

std::vector<CommandReadiness> ReadinessOf(const settings::Document& machine_file) {
  ReadAsCommandsDo(machine_file);
  const settings::Table root = machine_file.Root();
  const bool has_axes = root.Has("chain");
  std::vector<CommandReadiness> all;
  const auto add = [&](const char* commands, std::vector<std::string> missing) {
    all.push_back({commands, std::move(missing)});
  };
  const std::string axes = "chain and [axis.X], [axis.Y], [axis.Z] with travel_mm";
  const std::string head = "[head] with the five probes, [target] and [noise] (abbe init --head)";
  const std::string devices = "[devices.NAME]: the instruments to read (docs/devices.md)";
  const std::string linkage = "[linkage] with its form and lengths (docs/machine-file.md)";
  std::vector<std::string> sweep;
  if (!has_axes) sweep.push_back(axes);
  if (!root.Has("head")) sweep.push_back(head);
  if (!root.Has("sweep"))
    sweep.push_back("[sweep.X] with first_mm, last_mm and step_mm, one an axis");
  std::vector<std::string> measured = sweep;
  if (!root.Has("devices")) measured.push_back(devices);
  add("align, sweep", measured);
  add("reduce of a sweep, rig", sweep);
  add("record, doctor",
      root.Has("devices") ? std::vector<std::string>{} : std::vector<std::string>{devices});
  const std::string absent = has_axes ? AbsentAxes(root) : "";
  if (absent.empty()) {
    add("circle, path, plate, fuse, diagnose of a machine",
        has_axes ? std::vector<std::string>{} : std::vector<std::string>{axes});
  } else {
    add("path, fuse, diagnose of a machine", {});
    add("circle", absent.size() < 2 ? std::vector<std::string>{}
                                    : std::vector<std::string>{"a second axis, for a plane"});
    add("plate", {fmt::format("{}, for a volume: the machine has no such axis", absent)});
  }
  add("calibrate, diagnose of an arm",
      root.Has("linkage") ? std::vector<std::string>{} : std::vector<std::string>{linkage});
  add("diagnose of a turning shaft", {});
  add("history check", root.Has("limits") ? std::vector<std::string>{}
                                          : std::vector<std::string>{
                                                "[limits]: what you require (docs/history.md)"});
  return all;
}

}  // namespace abbe::apps
