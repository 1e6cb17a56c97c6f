#include "machine.h"

#include "apps/instruments.h"
#include "bindings.h"
#include "recording/made_on.h"

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

std::string MachineText(const MachineFile& file) {
  return fmt::format("<abbe.Machine \"{}\": {}{}{}>", file.machine().name,
                     file.machine().chain.Text(), file.instruments.head ? ", head" : "",
                     file.instruments.linkage ? ", linkage" : "");
}

}  // namespace

void MachineFile::RefuseOther(const recording::Recording& recording) const {
  recording::RefuseOtherMachine(recording, machine().name);
}

void BindMachine(py::module_& m) {
  py::class_<MachineFile>(m, "Machine",
                          "A machine and its instruments, as the machine file has them.")
      .def_property_readonly(
          "path", [](const MachineFile& f) { return f.path; }, "Its file.")
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
      "read_machine",
      [](const std::filesystem::path& path) {
        return MachineFile{path, apps::ReadInstruments(path)};
      },
      py::arg("path"),
      "read_machine(path)\n--\n\nReads a machine file. InputError with file, line and key.");
}

}  // namespace abbe::python
