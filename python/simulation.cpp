#include <limits>
#include <utility>

#include "apps/causes_option.h"
#include "bindings.h"
#include "machine.h"
#include "map/text_file.h"
#include "simulation/doubt.h"
#include "simulation/extended_model.h"

namespace abbe::python {
namespace {

using simulation::ExtendedModel;
using simulation::ModelledCause;

ExtendedModel ReadModel(const std::filesystem::path& path, const MachineFile& machine) {
  const auto& linkage = machine.instruments.linkage;
  return simulation::ReadExtendedModel(
      path, {machine.machine().name, true, linkage ? linkage->chain.joints() : Eigen::Index{0}});
}

// {"width_um": (7.98, 0.05)}: what it is, and its U95 or nan, in the unit of the name.
py::dict KeysOfModelled(const ModelledCause& modelled) {
  py::dict result;
  const auto& names = modelled.cause->keys;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const double unit = names[i].unit;
    const auto at = static_cast<Eigen::Index>(i);
    const double u95 = at < modelled.u95.size() ? modelled.u95[at] / unit
                                                : std::numeric_limits<double>::quiet_NaN();
    result[py::str(std::string(names[i].name))] = py::make_tuple(modelled.values[at] / unit, u95);
  }
  return result;
}

const apps::Corrections& CorrectionsFor(const std::string& purpose) {
  if (purpose == "measuring") return apps::kForMeasuring;
  if (purpose == "map") return apps::kForMaps;
  if (purpose == "calibrating") return apps::kForCalibrating;
  throw InputError(
      fmt::format("purpose: \"{}\"; give \"measuring\", \"map\" or \"calibrating\"", purpose));
}

recording::Recording Corrected(const recording::Recording& recording, const MachineFile& machine,
                               const std::filesystem::path& causes, const std::string& purpose,
                               bool although_unexplained) {
  machine.RefuseOther(recording);
  apps::CauseCorrection correction({causes, although_unexplained}, machine.instruments,
                                   CorrectionsFor(purpose));
  return correction.Take(recording);
}

}  // namespace

void BindSimulation(py::module_& m) {
  py::class_<ModelledCause>(m, "ModelledCause", "A cause of an extended model.")
      .def_property_readonly("name", &ModelledCause::Name, "\"backlash:X\".")
      .def_readonly("probability", &ModelledCause::probability, "Among its rivals.")
      .def_readonly("rivals", &ModelledCause::rivals, "What else it may be, most probable first.")
      .def_property_readonly("parameters", &KeysOfModelled,
                             "By name: the value and its U95 (nan: not stated), in the unit of the "
                             "name.")
      .def(
          "__repr__",
          [](const ModelledCause& s) {
            return fmt::format("<abbe.ModelledCause {}, probability {:.3f}>", s.Name(),
                               s.probability);
          },
          "__repr__(self, /)\n--\n\n");
  py::class_<ExtendedModel>(m, "ExtendedModel",
                            "The causes that a diagnosis found, as --causes of the program takes "
                            "them (docs/extended-model.md).")
      .def_readonly("machine", &ExtendedModel::machine)
      .def_readonly("verdict", &ExtendedModel::verdict,
                    "Of the diagnosis, \"explained\" ...; empty: not stated.")
      .def_readonly("causes", &ExtendedModel::causes)
      .def_property_readonly("unexplained", &simulation::UnexplainedText,
                             "What no cause explains, in words; empty: nothing.")
      .def_readonly("next_runs", &ExtendedModel::next_runs,
                    "That would tell causes from their rivals.")
      .def_property_readonly("text", &simulation::ExtendedModelText, "The file, TOML.")
      .def(
          "write",
          [](const ExtendedModel& s, const std::filesystem::path& path) {
            map::WriteWhole(simulation::ExtendedModelText(s), path);
          },
          py::arg("path"), "write(self, path)\n--\n\nAs TOML, with its verdict.")
      .def(
          "__repr__",
          [](const ExtendedModel& s) {
            std::string names;
            for (const ModelledCause& each : s.causes) names += " " + each.Name();
            return fmt::format("<abbe.ExtendedModel of \"{}\", {}:{}>", s.machine,
                               s.verdict.empty() ? "no verdict" : s.verdict,
                               names.empty() ? " no cause" : names);
          },
          "__repr__(self, /)\n--\n\n");
  m.def("read_model", &ReadModel, py::arg("path"), py::arg("machine"),
        "read_model(path, machine)\n--\n\n"
        "The extended model of Diagnosis.write or `abbe diagnose -o`. InputError with file, line "
        "and key; for the model of another machine.");
  m.def(
      "correct_recording", &Corrected, py::arg("recording"), py::arg("machine"), py::arg("causes"),
      py::arg("purpose") = "map", py::arg("although_unexplained") = false,
      py::call_guard<WithoutLock>(),
      "correct_recording(recording, machine, causes, purpose='map', "
      "although_unexplained=False)\n--\n\n"
      "A recording without the causes of an extended model (its file), as --causes of the "
      "program takes them out; its readings are another Recording.\n\n"
      "purpose: \"measuring\" takes out what is of the instrument, \"map\" also the motions that "
      "no map has, \"calibrating\" also what a map has. InputError for a model beside which "
      "something is unexplained, unless although_unexplained. What is not certain of the causes is "
      "in no U95 of what is computed from it.");
}

}  // namespace abbe::python
