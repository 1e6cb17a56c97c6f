// One function a folder of the library: what Python sees of it.
//
// A docstring begins with the signature, a line of "--" and an empty one: Python then knows the names of the
// arguments (inspect.signature), and mypy.stubtest holds the stubs in abbe/_abbe.pyi against them.
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "arrays.h"

namespace abbe::python {

// While it lives the lock of the interpreter is free: other threads of Python run, and between the
// steps of the computation Ctrl-C is looked for (failure/interruption.h).
using WithoutLock = py::gil_scoped_release;

// Data as dict, list, str, float, int, bool and None.
py::object ToPython(const nlohmann::ordered_json& json);

void BindFailure(py::module_& m);
void BindRecording(py::module_& m);
void BindMachine(py::module_& m);
void BindProbes(py::module_& m);
void BindMap(py::module_& m);
void BindCompensation(py::module_& m);
void BindPaths(py::module_& m);
void BindRelm(py::module_& m);
void BindFusion(py::module_& m);
void BindSimulation(py::module_& m);
void BindDiagnosis(py::module_& m);
void BindFleet(py::module_& m);

}  // namespace abbe::python
