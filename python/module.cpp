#include "bindings.h"

namespace abbe::python {
namespace {

// Everything belongs to the package for a reader of help() and of messages.
void NameAfterPackage(const py::module_& m) {
  for (const auto& [name, value] : m.attr("__dict__").cast<py::dict>()) {
    if (py::hasattr(value, "__module__")) py::setattr(value, "__module__", py::str("abbe"));
  }
}

}  // namespace
}  // namespace abbe::python

PYBIND11_MODULE(_abbe, m) {
  using namespace abbe::python;
  py::options options;
  options.disable_function_signatures();
  options.disable_enum_members_docstring();
  m.doc() = "The library of abbe; import abbe.";
  m.attr("__version__") = ABBE_VERSION;
  BindFailure(m);
  BindRecording(m);
  BindMachine(m);
  BindProbes(m);
  BindMap(m);
  BindCompensation(m);
  BindPaths(m);
  BindRelm(m);
  BindFusion(m);
  BindSimulation(m);
  BindDiagnosis(m);
  BindFleet(m);
  NameAfterPackage(m);
}
