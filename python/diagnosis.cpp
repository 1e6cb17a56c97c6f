#include "apps/diagnosis_result.h"
#include "bindings.h"
#include "diagnosis/diagnose.h"
#include "diagnosis/doubts.h"
#include "diagnosis/measured_noise.h"
#include "diagnosis/next_run.h"
#include "machine.h"
#include "simulation/kinds.h"

namespace abbe::python {
namespace {

using Recordings = std::vector<recording::Recording>;
using diagnosis::Finding;

struct Diagnosed {
  std::shared_ptr<diagnosis::Campaign> campaign;
  diagnosis::Diagnosis diagnosis;
  diagnosis::HeldOutGain gain;
};

Diagnosed Diagnose(const Recordings& recordings, const MachineFile& machine) {
  std::vector<simulation::RunSource> sources;
  for (const recording::Recording& each : recordings) sources.push_back(simulation::SourceOf(each));
  simulation::Instruments instruments = machine.instruments;
  simulation::RefuseStrangers(sources, instruments);
  diagnosis::UseMeasuredNoise(recordings, instruments);
  Diagnosed done{std::make_shared<diagnosis::Campaign>(std::move(instruments)), {}, {}};
  for (const recording::Recording& each : recordings) done.campaign->Add(each);
  done.diagnosis = diagnosis::Diagnose(*done.campaign);
  const diagnosis::Campaign& found = diagnosis::CampaignOf(done.diagnosis, *done.campaign);
  diagnosis::AddNextRuns(found, recordings, done.diagnosis);
  std::vector<diagnosis::Candidate> causes;
  for (const Finding& finding : done.diagnosis.findings) {
    if (diagnosis::IsModelled(finding)) causes.push_back(finding.score.candidate);
  }
  std::string why_not;
  done.gain = diagnosis::HoldOutWhereTheySuffice(found, recordings, causes, why_not);
  if (!why_not.empty()) done.diagnosis.notes.push_back(why_not);
  diagnosis::AddDoubtsOfHeldOut(done.gain, done.diagnosis);
  return done;
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
  py::class_<Diagnosed>(m, "Diagnosis", "The causes behind the errors of a machine.")
      .def_property_readonly(
          "verdict",
          [](const Diagnosed& s) { return std::string(diagnosis::Name(s.diagnosis.verdict)); },
          "\"clean\", \"explained\", \"ambiguous\" or \"unexplained\".")
      .def_property_readonly("findings", [](const Diagnosed& s) { return s.diagnosis.findings; })
      .def_property_readonly(
          "notes",
          [](const Diagnosed& s) {
            std::vector<std::string> notes = s.campaign->notes();
            notes.insert(notes.end(), s.diagnosis.notes.begin(), s.diagnosis.notes.end());
            return notes;
          },
          "How the recordings were taken, and what was found of their noise.")
      .def_property_readonly(
          "cannot_show", [](const Diagnosed& s) { return s.diagnosis.cannot_show; },
          "Causes that these recordings cannot show.")
      .def(
          "to_dict",
          [](const Diagnosed& s) { return ToPython(apps::DiagnosisJson(s.diagnosis, s.gain)); },
          "to_dict(self, /)\n--\n\nAll of it, the keys of docs/diagnose.md.")
      .def(
          "__str__", [](const Diagnosed& s) { return apps::DiagnosisText(s.diagnosis, s.gain); },
          "__str__(self, /)\n--\n\n")
      .def(
          "__repr__",
          [](const Diagnosed& s) {
            std::string names;
            for (const Finding& each : s.diagnosis.findings) {
              names += " " + each.score.candidate.Name();
            }
            return fmt::format("<abbe.Diagnosis {}:{}>", diagnosis::Name(s.diagnosis.verdict),
                               names.empty() ? " no cause found" : names);
          },
          "__repr__(self, /)\n--\n\n");
  m.def("diagnose", &Diagnose, py::arg("recordings"), py::arg("machine"),
        py::call_guard<WithoutLock>(),
        "diagnose(recordings, machine)\n--\n\n"
        "Which causes explain the recordings of a machine, as `abbe diagnose`. Takes a minute on a "
        "whole campaign; Ctrl-C ends it.");
}

}  // namespace abbe::python
