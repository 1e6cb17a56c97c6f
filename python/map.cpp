#include <algorithm>
#include <cmath>

#include "apps/map_json.h"
#include "bindings.h"
#include "error_map.h"
#include "failure/interruption.h"
#include "map/exporter.h"
#include "map/map_file.h"

namespace abbe::python {
namespace {

py::array Error(const Map& self, const Array& positions, const std::optional<Array>& tool) {
  const auto at = Columns<3>(positions, "positions_m");
  const Eigen::Vector3d p_TQ = self.Tool(tool);
  Eigen::Matrix3Xd errors;
  {
    const WithoutLock without_lock;
    errors = self.field.Errors(at, p_TQ);
  }
  return Rows(std::move(errors));
}

// Nine numbers a position, the matrices by rows.
template <typename At>
py::array Matrices(const Array& positions, const At& of) {
  const auto at = Columns<3>(positions, "positions_m");
  Eigen::Matrix<double, 9, Eigen::Dynamic> all(9, at.cols());
  {
    const WithoutLock without_lock;
    for (Eigen::Index i = 0; i < at.cols(); ++i) {
      MayBeInterrupted();
      Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(all.col(i).data()) = of(at.col(i));
    }
  }
  return Rows(std::move(all)).attr("reshape")(-1, 3, 3);
}

py::array Gradient(const Map& self, const Array& positions, const std::optional<Array>& tool) {
  constexpr Eigen::Index kAtOnce = 1024;
  const auto at = Columns<3>(positions, "positions_m");
  const Eigen::Vector3d p_TQ = self.Tool(tool);
  Eigen::Matrix<double, 9, Eigen::Dynamic> all(9, at.cols());
  {
    const WithoutLock without_lock;
    machine::VolumetricField::Linearized linear;
    for (Eigen::Index first = 0; first < at.cols(); first += kAtOnce) {
      MayBeInterrupted();
      self.field.Linearize(at.middleCols(first, std::min(kAtOnce, at.cols() - first)), p_TQ,
                           linear);
      for (Eigen::Index i = 0; i < linear.size(); ++i) {
        all.col(first + i) = linear.J_error_position(i).transpose().reshaped();
      }
    }
  }
  return Rows(std::move(all)).attr("reshape")(-1, 3, 3);
}

py::array Covariance(const Map& self, const Array& positions, const std::optional<Array>& tool) {
  const Eigen::Vector3d p_TQ = self.Tool(tool);
  return Matrices(positions,
                  [&](const Eigen::Vector3d& at) { return self.map.Covariance(at, p_TQ); });
}

py::array Uncertainty(const Map& self, const Array& positions, const std::optional<Array>& tool) {
  const auto at = Columns<3>(positions, "positions_m");
  const Eigen::Vector3d p_TQ = self.Tool(tool);
  Eigen::Matrix3Xd u(3, at.cols());
  {
    const WithoutLock without_lock;
    for (Eigen::Index i = 0; i < at.cols(); ++i) {
      MayBeInterrupted();
      u.col(i) = self.map.StandardUncertainty(at.col(i), p_TQ);
    }
  }
  return Rows(std::move(u));
}

py::tuple Curve(const Map& self, const std::string& name, const Array& positions) {
  const int error = map::ErrorNamed(name);
  if (error < 0) {
    throw InputError(fmt::format("error \"{}\": a map has EXX ... ECZ, A0Z, B0Z and C0Y", name));
  }
  auto curve = self.map.CurveOf(error, Numbers(positions, positions.size(), "positions_m"));
  return py::make_tuple(Rows(std::move(curve.value)), Rows(std::move(curve.u)));
}

py::dict Export(const Map& self, const std::filesystem::path& path, const std::string& format,
                const std::array<Eigen::Index, 3>& points, const std::optional<Array>& tool) {
  const map::ExportOptions options{points, self.Tool(tool)};
  const map::Export done = [&] {
    const WithoutLock without_lock;
    return map::ExportMap(self.map, map::FormatNamed(format), options, path);
  }();
  py::dict result;
  result["files"] = done.files;
  result["largest_m"] = done.discrepancy.largest;
  result["rms_m"] = done.discrepancy.rms;
  return result;
}

std::vector<std::string> Formats() {
  std::vector<std::string> names;
  for (const map::Format& format : map::Formats()) names.emplace_back(format.name);
  return names;
}

py::array Travels(const Map& self) {
  Eigen::Matrix<double, 2, 3> travels;
  for (int axis = 0; axis < 3; ++axis) {
    const auto& travel = self.map.model().travels()[axis];
    travels.col(axis) << travel.first, travel.last;
  }
  return Rows(travels);
}

}  // namespace

void BindMap(py::module_& m) {
  py::class_<Map>(m, "ErrorMap",
                  "The volumetric error of a machine, actual less nominal in the workpiece, with "
                  "its uncertainty.\n\npositions_m: (n, 3), [X Y Z] as commanded, within the "
                  "travels; tool_m: (3,), the tool point from the reference point; None: that of "
                  "the measurement.")
      .def_property_readonly("machine", [](const Map& s) { return s.map.origin().machine; })
      .def_property_readonly("chain", [](const Map& s) { return s.map.model().chain().Text(); })
      .def_property_readonly("travels_m", &Travels, "First and last of X, Y, Z, (3, 2).")
      .def_property_readonly(
          "tool_m", [](const Map& s) { return Rows(s.map.origin().tool); },
          "The tool point of the measurement, (3,).")
      .def_property_readonly(
          "states_uncertainty", [](const Map& s) { return s.map.StatesUncertainty(); },
          "Whether it has one; an imported map has none.")
      .def("error", &Error, py::arg("positions_m"), py::arg("tool_m") = py::none(),
           "error(self, positions_m, tool_m=None)\n--\n\nThe error, (n, 3), m.")
      .def("gradient", &Gradient, py::arg("positions_m"), py::arg("tool_m") = py::none(),
           "gradient(self, positions_m, tool_m=None)\n--\n\n"
           "Its slopes, (n, 3, 3): [i, j, k] is that of component j along axis k.")
      .def("standard_uncertainty", &Uncertainty, py::arg("positions_m"),
           py::arg("tool_m") = py::none(),
           "standard_uncertainty(self, positions_m, tool_m=None)\n--\n\nOf each component, "
           "(n, 3), m. U95 is twice that.")
      .def("covariance", &Covariance, py::arg("positions_m"), py::arg("tool_m") = py::none(),
           "covariance(self, positions_m, tool_m=None)\n--\n\n"
           "Of the components at each position, (n, 3, 3), m^2.")
      .def("curve", &Curve, py::arg("error"), py::arg("positions_m"),
           "curve(self, error, positions_m)\n--\n\n"
           "One of the 21 errors at positions of its axis, (n,): its values and their standard "
           "uncertainties, m or rad. A squareness (A0Z, B0Z, C0Y) is the same everywhere.")
      .def(
          "write",
          [](const Map& s, const std::filesystem::path& path) { map::WriteMap(s.map, path); },
          py::arg("path"), "write(self, path)\n--\n\nAs TOML, bit for bit.")
      .def("export", &Export, py::arg("path"), py::arg("format"),
           py::arg("points") = std::array<Eigen::Index, 3>{31, 31, 31},
           py::arg("tool_m") = py::none(),
           "export(self, path, format, points=(31, 31, 31), tool_m=None)\n--\n\n"
           "For another program: one of map_formats(). Returns the files written and by how much "
           "they differ from the map, m.")
      .def(
          "to_dict", [](const Map& s) { return ToPython(apps::MapJson(s.map)); },
          "to_dict(self, /)\n--\n\nOn a grid, and its 21 errors: the keys of docs/report.md.")
      .def(
          "__repr__",
          [](const Map& s) {
            return fmt::format("<abbe.ErrorMap of \"{}\": {}, scale {}{}>", s.map.origin().machine,
                               s.map.model().chain().Text(), s.map.Scale(),
                               s.map.StatesUncertainty() ? "" : ", no uncertainty");
          },
          "__repr__(self, /)\n--\n\n");
  m.def(
      "read_map",
      [](const std::filesystem::path& path, const std::string& chain, const std::string& positive) {
        return Map(map::ReadAnyMap(path, chain, positive));
      },
      py::arg("path"), py::arg("chain") = "", py::arg("positive") = "",
      py::call_guard<WithoutLock>(),
      "read_map(path, chain='', positive='')\n--\n\n"
      "A map of `abbe fuse`, or the tables of another program (docs/map.md), which need the "
      "chain \"[w X Y b Z t]\" and how the axes count, \"tool\" or \"carriage\".");
  m.def("map_formats", &Formats, "map_formats()\n--\n\nWhat ErrorMap.export writes.");
}

}  // namespace abbe::python
