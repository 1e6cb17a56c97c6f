#include "bindings.h"
#include "failure/interruption.h"
#include "machine.h"
#include "relm/error_model_name.h"
#include "relm/linkage_settings.h"
#include "relm/pivot_linkage.h"

namespace abbe::python {
namespace {

using namespace abbe::relm;

Elbow ElbowNamed(const std::string& elbow) {
  if (elbow == "up") return Elbow::kUp;
  if (elbow == "down") return Elbow::kDown;
  throw InputError(fmt::format("elbow: \"{}\"; give \"up\" or \"down\"", elbow));
}

py::array Tips(const PivotLinkage& self, const Array& angles) {
  const auto q = Columns<3>(angles, "angles_rad");
  Eigen::Matrix3Xd tips;
  {
    const WithoutLock without_lock;
    self.Tips(q, tips);
  }
  return Rows(std::move(tips));
}

py::tuple Angles(const PivotLinkage& self, const Array& tips, const std::string& elbow,
                 bool reach_over) {
  const auto p = Columns<3>(tips, "tips_m");
  const Branch branch{ElbowNamed(elbow), reach_over};
  Eigen::Matrix3Xd angles;
  std::vector<Reach> reach;
  {
    const WithoutLock without_lock;
    self.AnglesOf(p, branch, angles, reach);
  }
  py::array_t<bool> reached(static_cast<py::ssize_t>(reach.size()));
  for (std::size_t i = 0; i < reach.size(); ++i) {
    reached.mutable_at(static_cast<py::ssize_t>(i)) = reach[i] == Reach::kReached;
  }
  return py::make_tuple(Rows(std::move(angles)), reached);
}

py::array Jacobian(const PivotLinkage& self, const Array& angles) {
  const auto q = Columns<3>(angles, "angles_rad");
  Eigen::Matrix<double, 9, Eigen::Dynamic> all(9, q.cols());
  for (Eigen::Index i = 0; i < q.cols(); ++i) {
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(all.col(i).data()) =
        self.JacobianTipAngles(q.col(i));
  }
  return Rows(std::move(all)).attr("reshape")(-1, 3, 3);
}

LinkageModel MakeLinkage(const MachineFile& machine, const std::string& model) {
  return MakeLinkageModel(machine.instruments.LinkageFor(machine.name()), ErrorModelNamed(model));
}

LinkageReadings LinkageReadingsOf(const LinkageModel& model, const Array& angles,
                                  const std::optional<Array>& warmth) {
  LinkageReadings readings{ColumnsOf(angles, model.joints(), "angles_rad"), {}};
  if (warmth) readings.warmth = Numbers(*warmth, readings.poses(), "warmth_k");
  return readings;
}

Eigen::VectorXd ModelParameters(const LinkageModel& model, const std::optional<Array>& parameters) {
  if (!parameters) return model.Values();
  return Numbers(*parameters, model.parameters(), "parameters");
}

py::array ModelTips(const LinkageModel& self, const Array& angles,
                    const std::optional<Array>& warmth, const std::optional<Array>& parameters) {
  const auto readings = LinkageReadingsOf(self, angles, warmth);
  const Eigen::VectorXd x = ModelParameters(self, parameters);
  Eigen::Matrix3Xd tips;
  {
    const WithoutLock without_lock;
    self.Tips(readings, x, tips);
  }
  return Rows(std::move(tips));
}

py::array ModelJacobian(const LinkageModel& self, const Array& angles,
                        const std::optional<Array>& warmth,
                        const std::optional<Array>& parameters) {
  const auto readings = LinkageReadingsOf(self, angles, warmth);
  const Eigen::VectorXd x = ModelParameters(self, parameters);
  Eigen::Matrix3Xd tips;
  RowMatrix jacobian;
  {
    const WithoutLock without_lock;
    self.Tips(readings, x, tips, &jacobian);
  }
  const auto parameters_of_model = self.parameters();
  return Rows(Eigen::MatrixXd(jacobian.transpose())).attr("reshape")(-1, 3, parameters_of_model);
}

}  // namespace

void BindRelm(py::module_& m) {
  py::class_<PivotLinkage>(
      m, "PivotLinkage",
      "PivotLinkage(link_1_m, link_2_m)\n--\n\n"
      "The linkage of three pivots and two links, without errors, in closed form.\n\n"
      ">>> import abbe, numpy\n"
      ">>> linkage = abbe.PivotLinkage(0.120, 0.120)\n"
      ">>> tips_m = linkage.tips([[0.0, 0.0, 0.0]])\n"
      ">>> tips_m.tolist()\n"
      "[[0.12, 0.0, 0.12]]\n"
      ">>> angles_rad, reached = linkage.angles(tips_m)\n"
      ">>> bool(reached.all()), bool(numpy.allclose(linkage.tips(angles_rad), tips_m))\n"
      "(True, True)\n")
      .def(py::init<double, double>(), py::arg("link_1_m"), py::arg("link_2_m"),
           "__init__(self, link_1_m, link_2_m)\n--\n\n")
      .def_property_readonly("link_1_m", &PivotLinkage::link_1)
      .def_property_readonly("link_2_m", &PivotLinkage::link_2)
      .def("tips", &Tips, py::arg("angles_rad"),
           "tips(self, angles_rad)\n--\n\n"
           "The ball for angles (n, 3), seen from the base, (n, 3), m.")
      .def("angles", &Angles, py::arg("tips_m"), py::arg("elbow") = "up",
           py::arg("reach_over") = false,
           "angles(self, tips_m, elbow='up', reach_over=False)\n--\n\n"
           "The angles for balls (n, 3): (n, 3), rad, and whether each was reached, (n,); the "
           "angles of the others are 0.")
      .def("jacobian", &Jacobian, py::arg("angles_rad"),
           "jacobian(self, angles_rad)\n--\n\nOf the ball by the angles, (n, 3, 3), m/rad.")
      .def(
          "__repr__",
          [](const PivotLinkage& s) {
            return fmt::format("<abbe.PivotLinkage: links {:g} and {:g} mm>", 1e3 * s.link_1(),
                               1e3 * s.link_2());
          },
          "__repr__(self, /)\n--\n\n");
  py::class_<LinkageModel>(
      m, "LinkageModel",
      "LinkageModel(machine, model='complete')\n--\n\n"
      "The linkage of a machine file with the errors of a model: pivots, published, "
      "published-with-bearing or complete.\n\nangles_rad: (n, joints), as the encoders show them; "
      "warmth_k: (n,), above the reference temperature; parameters: (p,), SI, None: nominal.")
      .def(py::init(&MakeLinkage), py::arg("machine"), py::arg("model") = "complete",
           "__init__(self, machine, model='complete')\n--\n\n")
      .def_property_readonly("name", &LinkageModel::name)
      .def_property_readonly("joints", &LinkageModel::joints)
      .def_property_readonly("names", &LinkageModel::Names, "Of the parameters, p.")
      .def_property_readonly(
          "values", [](const LinkageModel& s) { return Rows(s.Values()); },
          "The nominal parameters, (p,), SI.")
      .def("tips", &ModelTips, py::arg("angles_rad"), py::arg("warmth_k") = py::none(),
           py::arg("parameters") = py::none(),
           "tips(self, angles_rad, warmth_k=None, parameters=None)\n--\n\n"
           "The ball seen from the base, (n, 3), m.")
      .def("jacobian", &ModelJacobian, py::arg("angles_rad"), py::arg("warmth_k") = py::none(),
           py::arg("parameters") = py::none(),
           "jacobian(self, angles_rad, warmth_k=None, parameters=None)\n--\n\n"
           "Of the ball by the parameters, (n, 3, p), SI.")
      .def(
          "__repr__",
          [](const LinkageModel& s) {
            return fmt::format("<abbe.LinkageModel \"{}\": {} joints, {} parameters>", s.name(),
                               s.joints(), s.parameters());
          },
          "__repr__(self, /)\n--\n\n");
}

}  // namespace abbe::python
