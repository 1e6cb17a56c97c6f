#include "machine.h"

#include <filesystem>
#include <map>
#include <utility>

#include "apps/instruments.h"
#include "bindings.h"
#include "map/text_file.h"
#include "recording/made_on.h"
#include "simulation/kinds.h"

namespace abbe::python {
namespace {

py::array TravelsOf(const MachineFile& file) {
  Eigen::Matrix<double, 2, 3> travels;
  for (int axis = 0; axis < 3; ++axis) {
    const machine::Travel& travel = file.machine().travels[axis];
    travels.col(axis) << travel.first, travel.last;
  }
  return Rows(travels);
}

MachineFile ReadMachine(const std::filesystem::path& path) {
  settings::Document::Read(path);  // says of a folder, a recording ... what it is
  return MachineFile({map::ReadWhole(path), path.string()});
}

MachineFile Changed(const MachineFile& file,
                    const std::map<std::string, settings::TomlValue>& values) {
  settings::TomlKeys keys = file.keys;
  for (const auto& [key, value] : values) keys = keys.With(key, value);
  return MachineFile(std::move(keys));
}

std::string MachineText(const MachineFile& file) {
  return fmt::format("<abbe.Machine \"{}\": {}{}{}>", file.machine().name,
                     file.machine().chain.Text(), file.instruments.head ? ", head" : "",
                     file.instruments.linkage ? ", linkage" : "");
}

}  // namespace

MachineFile::MachineFile(settings::TomlKeys of)
    : keys(std::move(of)), instruments(apps::InstrumentsIn(document())) {}

void MachineFile::RefuseOther(const recording::Recording& recording) const {
  recording::RefuseOtherMachine(recording, machine().name);
}

std::vector<simulation::RunSource> MachineFile::SourcesOf(
    const std::vector<recording::Recording>& recordings) const {
  std::vector<simulation::RunSource> sources;
  for (const recording::Recording& each : recordings) {
    RefuseOther(each);
    sources.push_back(simulation::SourceOf(each));
  }
  simulation::RefuseStrangers(sources, instruments);
  return sources;
}

void BindMachine(py::module_& m) {
  py::class_<MachineFile>(m, "Machine",
                          "A machine and its instruments, as the machine file has them.\n\n"
                          "It does not change: changed() gives another one. Its keys are named as "
                          "in messages, \"sweep.X.last_mm\", and have the units of their names.")
      .def_property_readonly(
          "path", [](const MachineFile& f) { return std::filesystem::path(f.name()); },
          "Its file, or the name that parse_machine was given.")
      .def_property_readonly(
          "text", [](const MachineFile& f) { return f.keys.text(); }, "The file, TOML.")
      .def(
          "keys", [](const MachineFile& f) { return f.keys.Names(); },
          "keys(self, /)\n--\n\nThe names of all keys that have a value.")
      .def(
          "__getitem__",
          [](const MachineFile& f, const std::string& key) { return f.keys.Value(key); },
          py::arg("key"),
          "__getitem__(self, key, /)\n--\n\n"
          "The value of a key as it is written, in the unit of its name.")
      .def("changed", &Changed, py::arg("values"),
           "changed(self, values)\n--\n\n"
           "The machine with other values of these keys, {\"sweep.X.last_mm\": 50.0}: bool, int, "
           "float, str or a list of one of the last two. Comments and all other keys stay; a key "
           "that is not there is added. InputError where the file would be refused.")
      .def(
          "write",
          [](const MachineFile& f, const std::filesystem::path& path) {
            map::WriteWhole(f.keys.text(), path);
          },
          py::arg("path"), "write(self, path)\n--\n\nIts text as a machine file.")
      .def_property_readonly("name", [](const MachineFile& f) { return f.machine().name; })
      .def_property_readonly(
          "chain", [](const MachineFile& f) { return f.machine().chain.Text(); },
          "\"[w X Y b Z t]\".")
      .def_property_readonly("travels_m", &TravelsOf, "First and last of X, Y, Z, (3, 2).")
      .def_property_readonly(
          "reference_m", [](const MachineFile& f) { return Rows(f.machine().reference); },
          "The reference point with all axes at zero, (3,).")
      .def_property_readonly(
          "has_head", [](const MachineFile& f) { return f.instruments.head.has_value(); },
          "Whether it has a head of five probes.")
      .def_property_readonly(
          "has_linkage", [](const MachineFile& f) { return f.instruments.linkage.has_value(); },
          "Whether it has a linkage.")
      .def("__repr__", &MachineText, "__repr__(self, /)\n--\n\n");
  m.def(
      "parse_machine",
      [](std::string text, std::string name) {
        return MachineFile({std::move(text), std::move(name)});
      },
      py::arg("text"), py::arg("name") = "machine",
      "parse_machine(text, name='machine')\n--\n\n"
      "The machine of a text, the content of a machine file; name: stands for the file in "
      "messages.");
  m.def("read_machine", &ReadMachine, py::arg("path"),
        "read_machine(path)\n--\n\nReads a machine file. InputError with file, line and key.");
}

}  // namespace abbe::python
