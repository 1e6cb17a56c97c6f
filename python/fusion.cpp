#include <algorithm>

#include "apps/arm_tables.h"
#include "apps/calibration_tables.h"
#include "apps/evaluate_plate.h"
#include "apps/fuse_result.h"
#include "bindings.h"
#include "error_map.h"
#include "fusion/arm_calibration.h"
#include "fusion/calibration_file.h"
#include "fusion/fuse_sources.h"
#include "machine.h"
#include "map/text_file.h"
#include "progress.h"
#include "relm/linkage_text.h"
#include "simulation/arm/arm_run.h"
#include "simulation/kinds.h"
#include "simulation/linkage/one_ball.h"

namespace abbe::python {
namespace {

using Recordings = std::vector<recording::Recording>;

struct Calibrated {
  fusion::CalibrationReport report;
  std::vector<simulation::LinkageRun> runs;
};

Calibrated Calibrate(const Recordings& recordings, const MachineFile& machine,
                     const std::string& model, bool displacement, int folds, const Asks& progress) {
  const auto& linkage = machine.instruments.LinkageFor(machine.name());
  fusion::CalibrateOptions options{.model = relm::ErrorModelNamed(model), .folds = folds};
  options.problem.displacement = displacement;
  return Long(progress, [&] {
    std::vector<simulation::LinkageRun> runs;
    simulation::OneBall ball("give recordings of one ball at a time");
    for (const recording::Recording& each : recordings) {
      machine.RefuseOther(each);
      runs.push_back(simulation::MeansOfStays(simulation::ReadLinkageRun(each, linkage)));
      ball.Add(each, runs.back());
    }
    auto report = fusion::Calibrate(machine.machine().chain, linkage, runs, options);
    report.calibration.machine = machine.machine().name;
    return Calibrated{std::move(report), std::move(runs)};
  });
}

std::vector<std::string> CalibrationNames(const Calibrated& self) {
  std::vector<std::string> names;
  for (const auto& block : self.report.calibration.blocks) {
    for (std::size_t i = 0; i < block.entries.size(); ++i) names.push_back(block.FullName(i));
  }
  return names;
}

py::array Entries(const Calibrated& self, double estimation::Parameter::*member) {
  std::vector<double> values;
  for (const auto& block : self.report.calibration.blocks) {
    for (const auto& entry : block.entries) values.push_back(entry.*member);
  }
  return py::array_t<double>(static_cast<py::ssize_t>(values.size()), values.data());
}

py::array Residuals(const Calibrated& self, Eigen::Vector3d fusion::PoseResidual::*member) {
  Eigen::Matrix3Xd gaps(3, self.report.residuals.size());
  for (Eigen::Index i = 0; i < gaps.cols(); ++i) gaps.col(i) = self.report.residuals[i].*member;
  return Rows(std::move(gaps));
}

struct CalibratedArm {
  fusion::ArmCalibration found;
  MachineFile machine;
};

CalibratedArm CalibrateArm(const Recordings& recordings, const MachineFile& machine,
                           const Recordings& tests) {
  const auto& linkage = machine.instruments.LinkageFor(machine.name());
  std::vector<simulation::RunSource> sources;
  const auto poses_of = [&](const Recordings& of) {
    std::vector<fusion::ArmPoses> poses;
    for (const recording::Recording& each : of) {
      machine.RefuseOther(each);
      sources.push_back(simulation::SourceOf(each));
      const simulation::LinkageRun run = simulation::ReadArmRun(each, linkage);
      poses.push_back({run, run});
    }
    return poses;
  };
  const auto runs = poses_of(recordings), held_out = poses_of(tests);
  simulation::RefuseStrangers(sources, machine.instruments);
  return {fusion::CalibrateArm(linkage, runs, held_out), machine};
}

void WriteArm(const CalibratedArm& self, const std::filesystem::path& path) {
  map::WriteWhole(relm::WithGeometry(self.machine.keys.text(), self.found.written, self.found.u95,
                                     self.machine.name()),
                  path);
}

std::vector<double> RmsOf(const std::vector<fusion::ArmFigures>& of,
                          fusion::Distances fusion::ArmFigures::*when) {
  std::vector<double> rms(of.size());
  std::transform(of.begin(), of.end(), rms.begin(),
                 [when](const fusion::ArmFigures& each) { return (each.*when).rms; });
  return rms;
}

fusion::FuseReport Fuse(const Recordings& recordings, const MachineFile& machine,
                        bool fixed_smoothness, int holdout, const Asks& progress) {
  return Long(progress, [&] {
    return fusion::FuseSources(machine.SourcesOf(recordings), machine.instruments,
                               {.choose_smoothness = !fixed_smoothness, .holdout = holdout});
  });
}

// The 21 errors by a hole plate.
apps::PlateResult EvaluatePlate(const Recordings& recordings, const MachineFile& machine,
                                int holdout, const std::optional<recording::Recording>& specimen,
                                bool fixed_smoothness, const Asks& progress) {
  return Long(progress, [&] {
    std::vector<simulation::PlateSetup> setups;
    for (const recording::Recording& each : recordings) {
      machine.RefuseOther(each);
      for (auto& setup : simulation::ReadPlate(each)) setups.push_back(std::move(setup));
    }
    if (specimen) machine.RefuseOther(*specimen);
    return apps::EvaluatePlate(
        machine.machine(), setups,
        {.fixed_smoothness = fixed_smoothness, .holdout = holdout, .specimen = specimen});
  });
}

}  // namespace

void BindFusion(py::module_& m) {
  py::class_<Calibrated>(m, "Calibration", "The parameters of a linkage, SI.")
      .def_property_readonly("names", &CalibrationNames, "Of the parameters, p.")
      .def_property_readonly(
          "values", [](const Calibrated& s) { return Entries(s, &estimation::Parameter::value); },
          "(p,), SI.")
      .def_property_readonly(
          "u", [](const Calibrated& s) { return Entries(s, &estimation::Parameter::uncertainty); },
          "Standard uncertainties, (p,); inf: not determined.")
      .def_property_readonly(
          "rms_before_m", [](const Calibrated& s) { return s.report.before.rms; },
          "In space, with the nominal parameters.")
      .def_property_readonly(
          "rms_m", [](const Calibrated& s) { return s.report.after.rms; },
          "In space, of all poses.")
      .def_property_readonly(
          "held_out_rms_m", [](const Calibrated& s) { return s.report.held_out.rms; },
          "In space, of poses that took no part; nan without folds.")
      .def_property_readonly(
          "residuals_m",
          [](const Calibrated& s) { return Residuals(s, &fusion::PoseResidual::gap); },
          "What is left at each pose, (n, 3).")
      .def_property_readonly(
          "residuals_before_m",
          [](const Calibrated& s) { return Residuals(s, &fusion::PoseResidual::before); },
          "The same with the nominal parameters, (n, 3).")
      .def(
          "write",
          [](const Calibrated& s, const std::filesystem::path& path) {
            fusion::WriteCalibration(s.report.calibration, path);
          },
          py::arg("path"), "write(self, path)\n--\n\nAs TOML, for linkage_path.")
      .def(
          "to_dict",
          [](const Calibrated& s) { return ToPython(apps::CalibrationJson(s.report, s.runs)); },
          "to_dict(self, /)\n--\n\nAll of it, the keys of docs/calibrate.md.")
      .def(
          "__str__", [](const Calibrated& s) { return apps::CalibrationTable(s.report, s.runs); },
          "__str__(self, /)\n--\n\n")
      .def(
          "__repr__",
          [](const Calibrated& s) {
            return fmt::format(
                "<abbe.Calibration \"{}\" of \"{}\": {:.2f} um rms, held out {:.2f}>",
                relm::ErrorModelName(s.report.calibration.model), s.report.calibration.machine,
                1e6 * s.report.after.rms, 1e6 * s.report.held_out.rms);
          },
          "__repr__(self, /)\n--\n\n");
  m.def("calibrate", &Calibrate, py::arg("recordings"), py::arg("machine"),
        py::arg("model") = "complete", py::arg("displacement") = false, py::arg("folds") = 5,
        py::arg("progress") = py::none(),
        "calibrate(recordings, machine, model='complete', displacement=False, folds=5, "
        "progress=None)\n--\n\n"
        "The parameters of the linkage from recordings of it, as `abbe calibrate`. "
        "progress(done, total, what): called as the work goes on.");
  py::class_<CalibratedArm>(m, "ArmCalibration",
                            "The numbers of an arm before an instrument, with U95.")
      .def_property_readonly(
          "rms_before_m",
          [](const CalibratedArm& s) { return RmsOf(s.found.runs, &fusion::ArmFigures::before); },
          "In space, of each recording, with the numbers of the machine file.")
      .def_property_readonly(
          "rms_m",
          [](const CalibratedArm& s) { return RmsOf(s.found.runs, &fusion::ArmFigures::after); },
          "In space, of each recording.")
      .def_property_readonly(
          "test_rms_before_m",
          [](const CalibratedArm& s) { return RmsOf(s.found.tests, &fusion::ArmFigures::before); },
          "Of each of the tests, which took no part.")
      .def_property_readonly(
          "test_rms_m",
          [](const CalibratedArm& s) { return RmsOf(s.found.tests, &fusion::ArmFigures::after); },
          "Of each of the tests, which took no part.")
      .def_property_readonly(
          "excess", [](const CalibratedArm& s) { return s.found.excess; },
          "What is left over the stated noise; U95 contains it.")
      .def("write", &WriteArm, py::arg("path"),
           "write(self, path)\n--\n\nThe machine file with the numbers found.")
      .def(
          "to_dict",
          [](const CalibratedArm& s) {
            return ToPython(apps::ArmCalibrationJson(s.found, s.machine.machine().name));
          },
          "to_dict(self, /)\n--\n\nAll of it, as `abbe calibrate --json`.")
      .def(
          "__str__", [](const CalibratedArm& s) { return apps::ArmCalibrationTable(s.found); },
          "__str__(self, /)\n--\n\n")
      .def(
          "__repr__",
          [](const CalibratedArm& s) {
            return fmt::format("<abbe.ArmCalibration of \"{}\": {} numbers>",
                               s.machine.machine().name, s.found.u95.size());
          },
          "__repr__(self, /)\n--\n\n");
  m.def("calibrate_arm", &CalibrateArm, py::arg("recordings"), py::arg("machine"),
        py::arg("tests") = Recordings{}, py::call_guard<WithoutLock>(),
        "calibrate_arm(recordings, machine, tests=[])\n--\n\n"
        "The numbers of an arm of any joints from poses before an instrument, as `abbe calibrate`; "
        "tests take no part. One ball only.");
  py::class_<fusion::FuseReport>(m, "FuseReport", "One error map from all recordings.")
      .def_property_readonly("map", [](const fusion::FuseReport& s) { return Map(s.map); })
      .def_readonly("noise", &fusion::FuseReport::noise, "Of each run, over what is stated.")
      .def_readonly("contradicting", &fusion::FuseReport::contradicting,
                    "The run that contradicts the others; -1: none.")
      .def(
          "to_dict", [](const fusion::FuseReport& s) { return ToPython(apps::FuseJson(s)); },
          "to_dict(self, /)\n--\n\nAll of it, the keys of docs/fuse.md.")
      .def("__str__", &apps::FuseTable, "__str__(self, /)\n--\n\n")
      .def(
          "__repr__",
          [](const fusion::FuseReport& s) {
            return fmt::format("<abbe.FuseReport of \"{}\": {} runs>", s.map.origin().machine,
                               s.runs.size());
          },
          "__repr__(self, /)\n--\n\n");
  m.def("fuse", &Fuse, py::arg("recordings"), py::arg("machine"),
        py::arg("fixed_smoothness") = false, py::arg("holdout") = 0,
        py::arg("progress") = py::none(),
        "fuse(recordings, machine, fixed_smoothness=False, holdout=0, progress=None)\n--\n\n"
        "One error map of the machine from recordings of any kind, as `abbe fuse`; holdout: every "
        "n-th block of rows is held out. progress(done, total, what): called as the work goes on; "
        "total grows while more is found to do.");
  py::class_<apps::PlateResult>(m, "PlateReport", "The 21 errors of a machine by a hole plate.")
      .def_property_readonly(
          "map", [](const apps::PlateResult& s) { return Map(s.fused.map); }, "The error map.")
      .def_property_readonly(
          "noise", [](const apps::PlateResult& s) { return s.fused.noise; },
          "Of each set-up, over what is stated.")
      .def(
          "to_dict", [](const apps::PlateResult& s) { return ToPython(apps::PlateJson(s)); },
          "to_dict(self, /)\n--\n\nAll of it, the keys of docs/plate.md.")
      .def("__str__", &apps::PlateTable, "__str__(self, /)\n--\n\n")
      .def(
          "__repr__",
          [](const apps::PlateResult& s) {
            return fmt::format("<abbe.PlateReport of \"{}\": {} set-ups>",
                               s.fused.map.origin().machine, s.fused.runs.size());
          },
          "__repr__(self, /)\n--\n\n");
  m.def("evaluate_plate", &EvaluatePlate, py::arg("recordings"), py::arg("machine"),
        py::arg("holdout") = 0, py::arg("specimen") = py::none(),
        py::arg("fixed_smoothness") = false, py::arg("progress") = py::none(),
        "evaluate_plate(recordings, machine, holdout=0, specimen=None, fixed_smoothness=False, "
        "progress=None)\n--\n\n"
        "The 21 errors of a machine from recordings of a hole plate, as `abbe plate`; holdout: "
        "every n-th hole is left out in turn; specimen: a recording of lengths, measured before "
        "and after correction. progress(done, total, what): called as the work goes on.");
}

}  // namespace abbe::python
