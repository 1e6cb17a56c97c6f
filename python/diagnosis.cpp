#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <tuple>

#include "apps/diagnose_plan.h"
#include "apps/diagnosis_result.h"
#include "apps/learned_result.h"
#include "apps/plan_result.h"
#include "bindings.h"
#include "learned/carried.h"
#include "learned/explain.h"
#include "learned/words.h"
#include "machine.h"
#include "map/text_file.h"
#include "progress.h"

namespace abbe::python {
namespace {

using diagnosis::Finding;
using diagnosis::Plan;
using diagnosis::PlannedCause;
using learned::Explanation;
using learned::Learned;

Explanation Diagnose(const std::vector<recording::Recording>& recordings,
                     const MachineFile& machine, bool learn,
                     const std::vector<std::filesystem::path>& carried, const Asks& progress) {
  return Long(progress, [&] {
    Explanation all =
        learned::Explain(recordings, machine.instruments, {learn, learned::CarriedFrom(carried)});
    if (all.why_no_gain) all.diagnosis.notes.push_back(*all.why_no_gain);
    return all;
  });
}

Plan PlanOf(std::vector<recording::Recording> recordings, const MachineFile& machine,
            const std::optional<std::string>& campaign) {
  for (const recording::Recording& each : recordings) machine.RefuseOther(each);
  if (campaign) {
    for (auto& path : apps::CampaignPaths(machine.document(), *campaign)) {
      recordings.push_back(std::move(path));
    }
  }
  if (recordings.empty()) {
    throw InputError("recordings: there is none, and no campaign; give runs to plan with");
  }
  return apps::PlanOfPaths(std::move(recordings), machine.instruments);
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
          "write",
          [](const Explanation& s, const std::filesystem::path& path,
             const std::vector<std::filesystem::path>& recordings) {
            map::WriteWhole(apps::ModelText(learned::ModelOf(s), recordings), path);
          },
          py::arg("path"), py::arg("recordings") = std::vector<std::filesystem::path>{},
          "write(self, path, recordings=())\n--\n\n"
          "The extended model with its verdict as a file, as `abbe diagnose -o`; recordings: the "
          "files it was found from, which are stated with their hashes.")
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
        py::arg("learned") = std::vector<std::filesystem::path>{}, py::arg("progress") = py::none(),
        "diagnose(recordings, machine, learn=False, learned=(), progress=None)\n--\n\n"
        "Which causes explain the recordings of a machine, as `abbe diagnose`. With `learn`, what "
        "no cause explains is learned; `learned` are extended models of other machines, whose "
        "terms compete. Takes a minute on a whole campaign; Ctrl-C ends it. progress(done, total, "
        "what): called as the work goes on; total grows while more is found to do.");
  py::class_<PlannedCause>(m, "PlannedCause", "A cause that planned runs would show, or not.")
      .def_property_readonly(
          "cause", [](const PlannedCause& s) { return s.candidate.cause->id; }, "\"backlash\".")
      .def_property_readonly(
          "object", [](const PlannedCause& s) { return s.candidate.object.name(); }, "\"X\" ...")
      .def_property_readonly(
          "name", [](const PlannedCause& s) { return s.candidate.Name(); }, "\"backlash:X\".")
      .def_readonly("visible", &PlannedCause::visible,
                    "Standard deviations by which one of plausible size stands out.")
      .def_property_readonly("seen", &PlannedCause::seen, "Whether it would be seen.")
      .def(
          "__repr__",
          [](const PlannedCause& s) {
            return fmt::format("<abbe.PlannedCause {}, {:.1f} sd>", s.candidate.Name(), s.visible);
          },
          "__repr__(self, /)\n--\n\n");
  py::class_<Plan>(m, "Plan", "Which causes a set of runs would show, before anything is measured.")
      .def_readonly("causes", &Plan::causes)
      .def_property_readonly(
          "cannot_show",
          [](const Plan& s) {
            return apps::PlanJson(s).at("cannot_show").get<std::vector<std::string>>();
          },
          "The names of those that would not be seen at their usual size.")
      .def_property_readonly(
          "alike",
          [](const Plan& s) {
            std::vector<std::tuple<std::string, std::string, double>> alike;
            for (const auto& [first, second, cosine] : s.alike) {
              alike.emplace_back(s.causes[first].candidate.Name(),
                                 s.causes[second].candidate.Name(), cosine);
            }
            return alike;
          },
          "Pairs of names that would be seen and not be separated, with their cosine.")
      .def(
          "to_dict", [](const Plan& s) { return ToPython(apps::PlanJson(s)); },
          "to_dict(self, /)\n--\n\nAll of it, the keys of docs/diagnose.md.")
      .def("__str__", &apps::PlanText, "__str__(self, /)\n--\n\n")
      .def(
          "__repr__",
          [](const Plan& s) {
            return fmt::format("<abbe.Plan: {} of {} causes would be seen>",
                               std::ranges::count_if(s.causes, &PlannedCause::seen),
                               s.causes.size());
          },
          "__repr__(self, /)\n--\n\n");
  m.def("plan", &PlanOf, py::arg("recordings"), py::arg("machine"),
        py::arg("campaign") = py::none(), py::call_guard<WithoutLock>(),
        "plan(recordings, machine, campaign=None)\n--\n\n"
        "Which causes runs on the paths of these recordings would show, and from which size on, as "
        "`abbe diagnose --plan`; their readings do not matter. campaign: the runs of one of the "
        "virtual rig besides, \"minimal\", \"standard\" or \"full\".");
}

}  // namespace abbe::python
