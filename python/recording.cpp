#include "recording/recording.h"

#include <algorithm>

#include "bindings.h"
#include "recording/recording_file.h"

namespace abbe::python {
namespace {

using recording::Recording;

py::array ColumnOf(const py::object& self, const std::string& name) {
  const auto values = self.cast<const Recording&>().At(name);
  return View(values.data(), values.size(), self);
}

std::vector<std::string> ColumnNames(const Recording& recording) {
  std::vector<std::string> names;
  for (const auto& column : recording.columns) names.push_back(column.name);
  return names;
}

Recording MakeRecording(std::string header, const py::dict& columns, std::string name) {
  Recording made{std::move(name), std::move(header), {}, {}};
  for (const auto& [key, value] : columns) {
    const auto array = value.cast<Array>();
    auto column = key.cast<std::string>();
    const auto values = Numbers(array, array.size(), column.c_str());
    made.columns.push_back({std::move(column), {values.begin(), values.end()}});
  }
  return made;
}

std::string RecordingText(const Recording& recording) {
  return fmt::format("<abbe.Recording \"{}\": {}, {} rows of {} columns>", recording.name,
                     recording.HeaderText("kind").value_or("no kind"), recording.rows(),
                     recording.columns.size());
}

}  // namespace

void BindRecording(py::module_& m) {
  py::class_<Recording>(m, "Recording",
                        "Recording(header, columns, name='recording')\n--\n\n"
                        "Raw readings: a header in TOML and named columns of numbers.\n\n"
                        "columns: dict of names, which end in the unit (\"probe_a_um\"), to arrays "
                        "(n,) in that unit.")
      .def(py::init(&MakeRecording), py::arg("header"), py::arg("columns"),
           py::arg("name") = "recording",
           "__init__(self, header, columns, name='recording')\n--\n\n")
      .def_readonly("name", &Recording::name, "The file that it came from, for messages.")
      .def_readonly("header", &Recording::header, "TOML text, one key a line.")
      .def_readonly("warnings", &Recording::warnings, "What reading it has to say.")
      .def_property_readonly("kind", &Recording::Kind, "\"sweep\", \"linkage\" ...")
      .def_property_readonly("columns", &ColumnNames, "The names of the columns.")
      .def("__getitem__", &ColumnOf, py::arg("column"),
           "__getitem__(self, column, /)\n--\n\n"
           "A column, (n,), in the unit of its name: a view, changes are kept.")
      .def(
          "__contains__",
          [](const Recording& r, const std::string& column) { return r.Find(column).has_value(); },
          py::arg("column"), "__contains__(self, column, /)\n--\n\n")
      .def("__len__", &Recording::rows, "__len__(self, /)\n--\n\n")
      .def("__repr__", &RecordingText, "__repr__(self, /)\n--\n\n")
      .def(
          "to_dict",
          [](const py::object& self) {
            py::dict dict;
            for (const std::string& name : ColumnNames(self.cast<const Recording&>())) {
              dict[py::str(name)] = ColumnOf(self, name);
            }
            return dict;
          },
          "to_dict(self, /)\n--\n\nThe columns by name, views of (n,) each.");
  m.def("read_recording", &recording::Read, py::arg("path"), py::call_guard<WithoutLock>(),
        "read_recording(path)\n--\n\nReads a recording, .csv or .h5.");
  m.def("write_recording", &recording::Write, py::arg("recording"), py::arg("path"),
        py::call_guard<WithoutLock>(),
        "write_recording(recording, path)\n--\n\n"
        "Writes a recording, .csv or .h5. InputError for one that read_recording would refuse.");
}

}  // namespace abbe::python
