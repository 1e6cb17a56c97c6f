#include <filesystem>

#include "apps/diagnosis_result.h"
#include "apps/learned_result.h"
#include "bindings.h"
#include "learned/carried.h"
#include "learned/explain.h"
#include "learned/words.h"
#include "machine.h"

namespace abbe::python {
namespace {

using diagnosis::Finding;
using learned::Explanation;
using learned::Learned;

Explanation Diagnose(const std::vector<recording::Recording>& recordings,
                     const MachineFile& machine, bool learn,
                     const std::vector<std::filesystem::path>& carried) {
  Explanation all =
      learned::Explain(recordings, machine.instruments, {learn, learned::CarriedFrom(carried)});
  if (all.why_no_gain) all.diagnosis.notes.push_back(*all.why_no_gain);
  return all;
}

// {"width_um": (7.98, 0.05)}: what it is, and its U95, in the unit of the name.
py::dict ParametersOf(const Finding& finding) {
  const diagnosis::Keys keys = diagnosis::KeysOf(finding.score);
  const auto& names = finding.score.candidate.cause->keys;
  py::dict result;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const double unit = names[i].unit;
    const auto at = static_cast<Eigen::Index>(i);
    result[py::str(std::string(names[i].name))] =
        py::make_tuple(keys.values[at] / unit, 2.0 * keys.u[at] / unit);
  }
  return result;
}

}  // namespace

void BindDiagnosis(py::module_& m) {
  py::class_<Finding>(m, "Finding", "A cause that was found.")
      .def_property_readonly(
          "cause", [](const Finding& s) { return s.score.candidate.cause->id; }, "\"backlash\".")
      .def_property_readonly(
          "object", [](const Finding& s) { return s.score.candidate.object.name(); },
          "\"X\", \"probe_a\" ...")
      .def_readonly("probability", &Finding::probability)
      .def_readonly("doubts", &Finding::doubts, "What keeps it from being certain.")
      .def_property_readonly("parameters", &ParametersOf,
                             "By name: the value and its U95, in the unit of the name.")
      .def_property_readonly(
          "rivals",
          [](const Finding& s) {
            py::dict rivals;
            for (const auto& each : s.rivals) {
              rivals[py::str(each.candidate.Name())] = each.probability;
            }
            return rivals;
          },
          "What else it may be, with probabilities.")
      .def_property_readonly(
          "next_run",
          [](const Finding& s) {
            return s.next_run ? std::optional(s.next_run->text) : std::nullopt;
          },
          "The run that would tell it from its rivals, or None.")
      .def(
          "__repr__",
          [](const Finding& s) {
            return fmt::format("<abbe.Finding {}, probability {:.3f}>", s.score.candidate.Name(),
                               s.probability);
          },
          "__repr__(self, /)\n--\n\n");
  py::class_<Learned>(m, "Term", "A term that was learned: what the simulation lacked.")
      .def_property_readonly(
          "object", [](const Learned& s) { return s.term().object; }, "Where it acts: \"EXX\" ...")
      .def_property_readonly(
          "expression", [](const Learned& s) { return s.term().expression.Text(); }, "\"x * y\".")
      .def_property_readonly(
          "words", [](const Learned& s) { return learned::InWords(s.term()); }, "A sentence.")
      .def_property_readonly("found", &Learned::IsFound, "Certified, held out and without a rival.")
      .def_readonly("doubts", &Learned::doubts, "What keeps it from being found.")
      .def_readonly("amplitude", &Learned::amplitude, "m or rad, rms over the rows of the runs.")
      .def(
          "__repr__",
          [](const Learned& s) {
            return fmt::format("<abbe.Term {} in {}, {}>", s.term().expression.Text(),
                               s.term().object, s.IsFound() ? "found" : "not certain");
          },
          "__repr__(self, /)\n--\n\n");
  py::class_<Explanation>(m, "Diagnosis", "The causes behind the errors of a machine.")
      .def_property_readonly(
          "verdict",
          [](const Explanation& s) { return std::string(diagnosis::Name(s.diagnosis.verdict)); },
          "\"clean\", \"explained\", \"learned\", \"ambiguous\" or \"unexplained\".")
      .def_property_readonly("findings", [](const Explanation& s) { return s.diagnosis.findings; })
      .def_property_readonly(
          "terms", [](const Explanation& s) { return s.learning.terms; },
          "What was learned, certain or not.")
      .def_property_readonly("notes", &Explanation::Notes,
                             "How the recordings were taken, and what was found of their noise.")
      .def_property_readonly(
          "cannot_show", [](const Explanation& s) { return s.diagnosis.cannot_show; },
          "Causes that these recordings cannot show.")
      .def(
          "model", [](const Explanation& s) { return ExtendedModelText(learned::ModelOf(s)); },
          "model(self, /)\n--\n\nThe extended model (TOML), for --causes of the program.")
      .def(
          "to_dict",
          [](const Explanation& s) {
            auto json = apps::DiagnosisJson(s.diagnosis, s.gain);
            apps::AddLearned(s.learning, json);
            return ToPython(json);
          },
          "to_dict(self, /)\n--\n\nAll of it, the keys of docs/diagnose.md.")
      .def(
          "__str__",
          [](const Explanation& s) {
            return apps::DiagnosisText(s.diagnosis, s.gain) + apps::LearnedText(s.learning);
          },
          "__str__(self, /)\n--\n\n")
      .def(
          "__repr__",
          [](const Explanation& s) {
            std::string names;
            for (const Finding& each : s.diagnosis.findings) {
              names += " " + each.score.candidate.Name();
            }
            return fmt::format("<abbe.Diagnosis {}:{}>", diagnosis::Name(s.diagnosis.verdict),
                               names.empty() ? " no cause found" : names);
          },
          "__repr__(self, /)\n--\n\n");
  m.def("diagnose", &Diagnose, py::arg("recordings"), py::arg("machine"), py::arg("learn") = false,
        py::arg("learned") = std::vector<std::filesystem::path>{}, py::call_guard<WithoutLock>(),
        "diagnose(recordings, machine, learn=False, learned=())\n--\n\n"
        "Which causes explain the recordings of a machine, as `abbe diagnose`. With `learn`, what "
        "no cause explains is learned; `learned` are extended models of other machines, whose "
        "terms compete. Takes a minute on a whole campaign; Ctrl-C ends it.");
}

}  // namespace abbe::python
