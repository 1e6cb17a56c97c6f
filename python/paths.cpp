#include "apps/circle_figures.h"
#include "apps/linkage_reader.h"
#include "bindings.h"
#include "machine.h"
#include "paths/circle_run.h"
#include "paths/path_deviation.h"
#include "settings/unit.h"

namespace abbe::python {
namespace {

using namespace abbe::paths;

struct Circle {
  CircleRun run;
  CircleFigures figures;
};

MeasuredPath LinkagePathOf(const recording::Recording& recording, const MachineFile& machine,
                           const std::optional<std::filesystem::path>& calibration) {
  machine.RefuseOther(recording);
  apps::LinkageReader reader(apps::ReadMachineFile(machine.document()), calibration.value_or(""));
  return reader.Path(recording);
}

std::vector<Circle> CirclesOf(const std::vector<MeasuredPath>& paths, const std::string& plane,
                              double radius, double filter) {
  std::vector<Circle> circles;
  for (CircleRun& run : CircleRuns(paths, {.plane = plane, .radius = radius})) {
    Circle circle{Filtered(run, filter), {}};
    circle.figures = EvaluateCircle(circle.run);
    circles.push_back(std::move(circle));
  }
  return circles;
}

py::dict CircleFiguresOf(const Circle& circle) {
  py::dict figures;
  for (const apps::CircleFigure& each : apps::kCircleFigures) {
    if (const auto value = each.of(circle.figures)) {
      figures[py::str(fmt::format("{}_m", settings::StemOf(each.key)))] = *value;
    }
  }
  return figures;
}

py::array PointsOf(const Circle& circle) {
  Eigen::Matrix3Xd points(3, circle.run.points.size());
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const CirclePoint& point = circle.run.points[i];
    points.col(i) << point.first, point.second, point.third;
  }
  return Rows(std::move(points));
}

py::array AnglesOf(const Circle& circle) {
  Eigen::VectorXd angles(circle.run.points.size());
  for (Eigen::Index i = 0; i < angles.size(); ++i) angles[i] = circle.run.points[i].angle;
  return Rows(std::move(angles));
}

py::array SensesOf(const Circle& circle) {
  Eigen::VectorXd senses(circle.run.points.size());
  for (Eigen::Index i = 0; i < senses.size(); ++i) senses[i] = circle.run.points[i].sense;
  return Rows(std::move(senses));
}

template <typename Matrix>
py::array ViewOf(const py::object& self, Matrix MeasuredPath::*member) {
  const Matrix& of = self.cast<const MeasuredPath&>().*member;
  if (of.rows() != 3 || Matrix::ColsAtCompileTime == 1) return View(of.data(), of.size(), self);
  return py::array_t<double>({of.cols(), of.rows()}, {}, of.data(), self);
}

}  // namespace

void BindPaths(py::module_& m) {
  py::class_<MeasuredPath>(m, "MeasuredPath",
                           "A path as commanded and as measured, in axis coordinates.")
      .def_readonly("recording", &MeasuredPath::recording)
      .def_readonly("instrument", &MeasuredPath::instrument, "\"linkage\" or \"reference\".")
      .def_property_readonly(
          "commanded_m", [](const py::object& s) { return ViewOf(s, &MeasuredPath::commanded); },
          "(n, 3).")
      .def_property_readonly(
          "measured_m", [](const py::object& s) { return ViewOf(s, &MeasuredPath::measured); },
          "(n, 3); coordinates that were not measured are the commanded ones.")
      .def_property_readonly(
          "time_s", [](const py::object& s) { return ViewOf(s, &MeasuredPath::time); }, "(n,).")
      .def_property_readonly(
          "feed_m_s", [](const py::object& s) { return ViewOf(s, &MeasuredPath::feed); },
          "(n,); 0: not stated.")
      .def("__len__", &MeasuredPath::poses, "__len__(self, /)\n--\n\n")
      .def(
          "__repr__",
          [](const MeasuredPath& s) {
            return fmt::format("<abbe.MeasuredPath \"{}\": {} poses by the {}>", s.recording,
                               s.poses(), s.instrument);
          },
          "__repr__(self, /)\n--\n\n");
  m.def("reference_path", &ReferencePath, py::arg("recording"), py::call_guard<WithoutLock>(),
        "reference_path(recording)\n--\n\nThe path that a reference instrument measured.");
  m.def("linkage_path", &LinkagePathOf, py::arg("recording"), py::arg("machine"),
        py::arg("calibration") = py::none(), py::call_guard<WithoutLock>(),
        "linkage_path(recording, machine, calibration=None)\n--\n\n"
        "The path of the ball by the linkage; calibration: file of Calibration.write or `abbe "
        "calibrate`, None: nominal parameters.");
  py::class_<PathDeviation>(m, "PathDeviation", "Measured less the nearest nominal point.")
      .def_property_readonly(
          "deviation_m", [](const PathDeviation& s) { return Rows(Eigen::Matrix3Xd(s.deviation)); },
          "(n, 3).")
      .def_property_readonly(
          "along_m", [](const PathDeviation& s) { return Rows(Eigen::VectorXd(s.along)); },
          "How far along the nominal path, (n,).")
      .def_readonly("length_m", &PathDeviation::length, "Of the nominal path.")
      .def_readonly("largest_m", &PathDeviation::largest)
      .def_readonly("rms_m", &PathDeviation::rms)
      .def(
          "__repr__",
          [](const PathDeviation& s) {
            return fmt::format("<abbe.PathDeviation: largest {:.3f} um, rms {:.3f} um>",
                               1e6 * s.largest, 1e6 * s.rms);
          },
          "__repr__(self, /)\n--\n\n");
  m.def(
      "path_deviation",
      [](const MeasuredPath& path, const std::optional<Array>& nominal, bool align) {
        DeviationOptions options{.nominal = {}, .align = align};
        if (nominal) options.nominal = Columns<3>(*nominal, "nominal_m");
        return DeviationFrom(path, options);
      },
      py::arg("path"), py::arg("nominal_m") = py::none(), py::arg("align") = false,
      "path_deviation(path, nominal_m=None, align=False)\n--\n\n"
      "From straight pieces through nominal_m, (n, 3), or from the commanded path; align: moved "
      "as a rigid body first.");
  py::class_<Circle>(m, "Circle", "A circular test in one plane at one feed, both senses.")
      .def_property_readonly(
          "plane", [](const Circle& s) { return s.run.plane.name; }, "\"XY\" ..., \"inclined\".")
      .def_property_readonly("instrument", [](const Circle& s) { return s.run.instrument; })
      .def_property_readonly(
          "radius_m", [](const Circle& s) { return s.run.radius; }, "Nominal.")
      .def_property_readonly("feed_m_s", [](const Circle& s) { return s.run.feed; })
      .def_property_readonly("points_m", &PointsOf,
                             "(n, 3): along both axes of the plane and its normal, from the "
                             "commanded centre.")
      .def_property_readonly("angle_rad", &AnglesOf, "(n,).")
      .def_property_readonly("sense", &SensesOf, "(n,): 1 counter-clockwise, -1 clockwise.")
      .def_property_readonly("figures_m", &CircleFiguresOf,
                             "The figures of ISO 230-4 that were measured, by name.")
      .def(
          "__repr__",
          [](const Circle& s) {
            return fmt::format("<abbe.Circle {} by the {}: radius {:g} mm, {} points>",
                               s.run.plane.name, s.run.instrument, 1e3 * s.run.radius,
                               s.run.points.size());
          },
          "__repr__(self, /)\n--\n\n");
  m.def("circles", &CirclesOf, py::arg("paths"), py::arg("plane") = "", py::arg("radius_m") = 0.0,
        py::arg("filter") = 0.0, py::call_guard<WithoutLock>(),
        "circles(paths, plane='', radius_m=0.0, filter=0.0)\n--\n\n"
        "The circular tests in measured paths, as `abbe circle`; filter: undulations a turn, 0: "
        "none; radius_m 0: that of the recording. Their uncertainties are those of the program.");
}

}  // namespace abbe::python
