#include <array>

#include "apps/reduce_sweep.h"
#include "bindings.h"
#include "machine.h"
#include "probes/head_inversion.h"
#include "probes/inversion_of_rows.h"
#include "probes/sweep_reduction.h"

namespace abbe::python {
namespace {

using namespace abbe::probes;

MovingBody MovingNamed(const std::string& moving) {
  if (moving == "target") return MovingBody::kTarget;
  if (moving == "head") return MovingBody::kHead;
  throw InputError(fmt::format("moving: \"{}\"; give \"target\" or \"head\"", moving));
}

[[noreturn]] void RefuseModel(const std::string& model, const char* names) {
  throw InputError(fmt::format("model: \"{}\"; give one of {}", model, names));
}

// A layout from (5, 2) numbers: u and s of A, B, C, u and n of D, E.
HeadLayout<> LayoutOf(const std::optional<Array>& layout) {
  if (!layout) return NominalLayout();
  const auto at = Columns<2>(*layout, "layout_m");
  if (at.cols() != static_cast<Eigen::Index>(kProbes)) {
    throw InputError(fmt::format("layout_m: has {} rows; give one a probe, (5, 2)", at.cols()));
  }
  HeadLayout<> made{};
  for (std::size_t i = 0; i < kTopProbes; ++i) made.top[i] = {at(0, i), at(1, i)};
  for (std::size_t i = 0; i < kSideProbes; ++i) {
    made.side[i] = {at(0, kTopProbes + i), at(1, kTopProbes + i)};
  }
  return made;
}

py::array LayoutArray(double arm, double side_height) {
  const auto layout = NominalLayout(arm, side_height);
  Eigen::Matrix<double, 2, 5> at;
  for (std::size_t i = 0; i < kTopProbes; ++i) at.col(i) << layout.top[i].u, layout.top[i].s;
  for (std::size_t i = 0; i < kSideProbes; ++i) {
    at.col(kTopProbes + i) << layout.side[i].u, layout.side[i].n;
  }
  return Rows(at);
}

PerProbe<> ReadingsAt(const double* row) { return {row[0], row[1], row[2], row[3], row[4]}; }

template <typename Model>
ReadingRows ReadingsOf(const Eigen::Map<const ErrorRows>& errors, const double* travel,
                       const Model& model) {
  const WithoutLock without_lock;
  ReadingRows readings(static_cast<int>(kProbes), errors.cols());
  for (Eigen::Index i = 0; i < errors.cols(); ++i) {
    const auto e = errors.col(i);
    const PerProbe<> row = model(HeadErrors<>{e[0], e[1], e[2], e[3], e[4], e[5]}, travel[i]);
    std::copy(row.begin(), row.end(), readings.col(i).data());
  }
  return readings;
}

py::array HeadReadings(const Array& errors, const Array& travel, const std::string& moving,
                       const std::string& model, const std::optional<Array>& layout) {
  const auto e = Columns<6>(errors, "errors");
  const double* d = Numbers(travel, e.cols(), "travel_m").data();
  const HeadLayout<> at = LayoutOf(layout);
  const MovingBody body = MovingNamed(moving);
  if (model == "rigid") {
    const auto lines = LinesOf(at);
    return Rows(ReadingsOf(e, d, [&](const HeadErrors<>& errors_at, double d_at) {
      return RigidReadings(lines, body, errors_at, d_at);
    }));
  }
  if (model != "small-angle") RefuseModel(model, "\"rigid\", \"small-angle\"");
  return Rows(ReadingsOf(e, d, [&](const HeadErrors<>& errors_at, double d_at) {
    return SmallAngleReadings(at, body, errors_at, d_at);
  }));
}

template <typename Inversion>
py::array Inverted(const Array& readings, const Array& travel, const std::optional<Array>& exx,
                   const Inversion& invert) {
  const auto r = Columns<kProbes>(readings, "readings_m");
  const double* d = Numbers(travel, r.cols(), "travel_m").data();
  const double* x = exx ? Numbers(*exx, r.cols(), "positioning_m").data() : nullptr;
  ErrorRows errors(6, r.cols());
  {
    const WithoutLock without_lock;
    for (Eigen::Index i = 0; i < r.cols(); ++i) {
      const auto e = invert(ReadingsAt(r.col(i).data()), d[i], x ? x[i] : 0.0);
      errors.col(i) << e.eax, e.ebx, e.ecx, e.eyx, e.ezx, e.exx;
    }
  }
  return Rows(std::move(errors));
}

// By the kernels for many stations.
py::array InvertedSmall(const Array& readings, const Array& travel, const std::optional<Array>& exx,
                        const SmallAngleInversion& invert) {
  const auto r = Columns<kProbes>(readings, "readings_m");
  const auto d = Numbers(travel, r.cols(), "travel_m");
  Eigen::Map<const Eigen::VectorXd> x(nullptr, 0);
  if (exx) new (&x) Eigen::Map<const Eigen::VectorXd>(Numbers(*exx, r.cols(), "positioning_m"));
  ErrorRows errors(6, r.cols());
  {
    const WithoutLock without_lock;
    InvertRows(invert, r, d, x, errors);
  }
  return Rows(std::move(errors));
}

py::array InvertHead(const Array& readings, const Array& travel, const std::string& moving,
                     const std::string& model, const std::optional<Array>& layout,
                     const std::optional<Array>& exx) {
  const HeadLayout<> at = LayoutOf(layout);
  const MovingBody body = MovingNamed(moving);
  if (model == "rigid") return Inverted(readings, travel, exx, RigidInversion(LinesOf(at), body));
  if (model == "small-angle") {
    return InvertedSmall(readings, travel, exx, SmallAngleInversion(at, body));
  }
  if (model == "simplified") return Inverted(readings, travel, exx, SimplifiedInversion(at, body));
  RefuseModel(model, "\"rigid\", \"small-angle\", \"simplified\"");
}

SweepResult Reduce(const recording::Recording& recording, const MachineFile& machine) {
  machine.RefuseOther(recording);
  const auto& i = machine.instruments;
  return ReduceSweep(recording, {i.machine, i.HeadFor(recording.name), i.target, i.noise});
}

const ComponentResult& ComponentNamed(const SweepResult& result, const std::string& name) {
  std::string names;
  for (const ComponentResult& component : result.components) {
    if (component.component.name == name) return component;
    names += (names.empty() ? "" : ", ") + component.component.name;
  }
  throw InputError(fmt::format("error \"{}\": the sweep of {} has {}", name, result.axis, names));
}

py::array Of(const py::object& self, const Eigen::VectorXd& values) {
  return View(values.data(), values.size(), self);
}

}  // namespace

void BindProbes(py::module_& m) {
  m.def("nominal_layout", &LayoutArray, py::arg("arm_m") = 10e-3, py::arg("side_height_m") = 20e-3,
        "nominal_layout(arm_m=0.01, side_height_m=0.02)\n--\n\n"
        "Where the five probes of the published head look, (5, 2), m: u and s of A, B, C, u and n "
        "of D, E.");
  m.def("head_readings", &HeadReadings, py::arg("errors"), py::arg("travel_m"),
        py::arg("moving") = "target", py::arg("model") = "rigid", py::arg("layout_m") = py::none(),
        "head_readings(errors, travel_m, moving='target', model='rigid', layout_m=None)\n--\n\n"
        "The readings of the five probes, (n, 5), m, in the order A to E.\n\n"
        "errors: (n, 6), a row [EAX EBX ECX EYX EZX EXX] in rad and m; travel_m: (n,).\n"
        "moving: \"target\" or \"head\"; model: \"rigid\" or \"small-angle\".\n\n"
        ">>> import abbe, numpy\n"
        ">>> errors = numpy.array([[50e-6, -200e-6, 1e-3, 3e-6, -2e-6, 0.0]])\n"
        ">>> readings_m = abbe.head_readings(errors, [0.060])\n"
        ">>> readings_m.shape\n"
        "(1, 5)\n"
        ">>> numpy.allclose(abbe.invert_head(readings_m, [0.060]), errors, rtol=0, atol=1e-15)\n"
        "True\n");
  m.def("invert_head", &InvertHead, py::arg("readings_m"), py::arg("travel_m"),
        py::arg("moving") = "target", py::arg("model") = "rigid", py::arg("layout_m") = py::none(),
        py::arg("positioning_m") = py::none(),
        "invert_head(readings_m, travel_m, moving='target', model='rigid', layout_m=None, "
        "positioning_m=None)\n--\n\n"
        "The errors of the swept axis, (n, 6), a row [EAX EBX ECX EYX EZX EXX] in rad and m.\n\n"
        "readings_m: (n, 5); travel_m: (n,); positioning_m: EXX where it is known, (n,).\n"
        "model: \"rigid\" and \"small-angle\" are exact, \"simplified\" is of first order.\n"
        "NumericalError for readings that no small motion gives.");
  py::class_<SweepResult>(m, "SweepResult",
                          "The errors of a swept axis with their uncertainty, actual less nominal.")
      .def_property_readonly(
          "axis", [](const SweepResult& r) { return std::string(1, r.axis); },
          "\"X\", \"Y\" or \"Z\".")
      .def_readonly("machine", &SweepResult::machine)
      .def_readonly("notes", &SweepResult::notes)
      .def_property_readonly(
          "stations_m",
          [](const py::object& self) {
            const auto& at = self.cast<const SweepResult&>().stations;
            return View(at.data(), at.size(), self);
          },
          "Where the axis stood, (n,), ascending.")
      .def_property_readonly(
          "errors",
          [](const SweepResult& r) {
            std::vector<std::string> names;
            for (const auto& each : r.components) {
              names.push_back(each.component.name);
            }
            return names;
          },
          "The names of the errors: three angles, two straightnesses.")
      .def(
          "value",
          [](const py::object& self, const std::string& error) {
            return Of(self, ComponentNamed(self.cast<const SweepResult&>(), error).value);
          },
          py::arg("error"), "value(self, error)\n--\n\nAn error at the stations, (n,), rad or m.")
      .def(
          "u",
          [](const py::object& self, const std::string& error) {
            return Of(self, ComponentNamed(self.cast<const SweepResult&>(), error).u);
          },
          py::arg("error"), "u(self, error)\n--\n\nIts standard uncertainty, (n,), rad or m.")
      .def(
          "coverage",
          [](const SweepResult& r, const std::string& error) {
            return ComponentNamed(r, error).coverage;
          },
          py::arg("error"), "coverage(self, error)\n--\n\nU95 = coverage * u.")
      .def(
          "to_dict", [](const SweepResult& r) { return ToPython(apps::SweepJson(r)); },
          "to_dict(self, /)\n--\n\nAll of it, the keys of docs/sweep.md.")
      .def("__str__", &apps::SweepTable, "__str__(self, /)\n--\n\n")
      .def(
          "__repr__",
          [](const SweepResult& r) {
            return fmt::format("<abbe.SweepResult {} of \"{}\": {} stations, {} passes>", r.axis,
                               r.machine, r.stations.size(), r.passes);
          },
          "__repr__(self, /)\n--\n\n");
  m.def("reduce_sweep", &Reduce, py::arg("recording"), py::arg("machine"),
        py::call_guard<WithoutLock>(),
        "reduce_sweep(recording, machine)\n--\n\n"
        "The five errors of an axis from a recording of the head, as `abbe reduce`.");
}

}  // namespace abbe::python
