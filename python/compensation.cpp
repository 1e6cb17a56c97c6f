#include "bindings.h"
#include "compensation/corrector.h"
#include "compensation/performance.h"
#include "error_map.h"
#include "failure/interruption.h"

namespace abbe::python {
namespace {

using compensation::Corrector;

Corrector MakeCorrector(const Map& map, const std::optional<Array>& tool,
                        const std::optional<Array>& zero) {
  Corrector corrector(map.map, map.Tool(tool));
  if (zero) corrector.KeepZero(Numbers(*zero, 3, "zero_m"));
  return corrector;
}

template <typename Of>
py::array Each(const Array& positions, const Of& of) {
  const auto at = Columns<3>(positions, "positions_m");
  Eigen::Matrix3Xd result(3, at.cols());
  {
    const WithoutLock without_lock;
    for (Eigen::Index i = 0; i < at.cols(); ++i) {
      MayBeInterrupted();
      result.col(i) = of(at.col(i));
    }
  }
  return Rows(std::move(result));
}

py::dict FiguresOf(const std::vector<compensation::Figure>& figures) {
  py::dict result;
  for (const auto& figure : figures) result[py::str(figure.name)] = figure.value;
  return result;
}

py::dict Simulate(const Map& map, const std::string& test, const std::optional<Array>& tool,
                  double radius, const std::optional<Array>& path, int draws, std::uint64_t seed) {
  compensation::TestSize size{.radius = radius, .path = {}};
  if (path) size.path = Columns<3>(*path, "path_m");
  const Eigen::Vector3d p_TQ = map.Tool(tool);
  std::vector<compensation::Figure> as_is, corrected;
  {
    const WithoutLock without_lock;
    const auto made = compensation::MakeTest(test, map.map, size);
    as_is = made.evaluate(compensation::MadeBy(map.map.model(), p_TQ, made.wanted));
    if (draws > 0) corrected = compensation::AfterCorrection(map.map, p_TQ, made, draws, seed);
  }
  py::dict result;
  result["as_is"] = FiguresOf(as_is);
  if (draws > 0) result["corrected_p95"] = FiguresOf(corrected);
  return result;
}

std::vector<std::string> Tests() {
  const auto names = compensation::TestNames();
  return {names.begin(), names.end()};
}

}  // namespace

void BindCompensation(py::module_& m) {
  py::class_<Corrector>(m, "Corrector",
                        "Corrector(map, tool_m=None, zero_m=None)\n--\n\n"
                        "Commands that bring the tool to wanted positions, by an error map.\n\n"
                        "zero_m: (3,), where the zero was touched off; its error is in the zero.")
      .def(py::init(&MakeCorrector), py::arg("map"), py::arg("tool_m") = py::none(),
           py::arg("zero_m") = py::none(), "__init__(self, map, tool_m=None, zero_m=None)\n--\n\n")
      .def(
          "command",
          [](const Corrector& s, const Array& positions) {
            return Each(positions, [&s](const Eigen::Vector3d& at) { return s.Command(at); });
          },
          py::arg("positions_m"),
          "command(self, positions_m)\n--\n\nWhat to command for wanted positions, (n, 3), m.")
      .def(
          "made",
          [](const Corrector& s, const Array& positions) {
            return Each(positions, [&s](const Eigen::Vector3d& at) { return s.Made(at); });
          },
          py::arg("positions_m"),
          "made(self, positions_m)\n--\n\nWhere the machine goes for commands, (n, 3), m.")
      .def(
          "__repr__", [](const Corrector&) { return "<abbe.Corrector>"; },
          "__repr__(self, /)\n--\n\n");
  m.def("simulate", &Simulate, py::arg("map"), py::arg("test"), py::arg("tool_m") = py::none(),
        py::arg("radius_m") = 0.0, py::arg("path_m") = py::none(), py::arg("draws") = 0,
        py::arg("seed") = 1,
        "simulate(map, test, tool_m=None, radius_m=0.0, path_m=None, draws=0, seed=1)\n--\n\n"
        "The figures of the standards for a test piece made on the machine, in m and rad: as it "
        "is, and with draws > 0 the bound that 95 % of so many corrected machines keep, drawn by "
        "the covariance of the map.\n\ntest: one of test_names(); path_m: (n, 3), of "
        "\"freeform\".");
  m.def("test_names", &Tests, "test_names()\n--\n\nThe test pieces that simulate knows.");
}

}  // namespace abbe::python
