#include "failure/failure.h"

#include <unistd.h>

#include <chrono>

#include "bindings.h"
#include "failure/interruption.h"

namespace abbe::python {
namespace {

py::object MakeException(py::module_& m, const char* name, const char* doc,
                         const py::object& bases) {
  const std::string full = std::string("abbe.") + name;
  auto made = py::reinterpret_steal<py::object>(
      PyErr_NewExceptionWithDoc(full.c_str(), doc, bases.ptr(), nullptr));
  if (!made) throw py::error_already_set();
  m.add_object(name, made);
  return made;
}

// The exceptions of the module; never freed, as Python may translate one while it ends.
struct Exceptions {
  py::object failure, input, device, numerical;
};
Exceptions* exceptions = nullptr;

void Translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const InputError& error) {
    PyErr_SetString(exceptions->input.ptr(), error.what());
  } catch (const DeviceError& error) {
    PyErr_SetString(exceptions->device.ptr(), error.what());
  } catch (const NumericalError& error) {
    PyErr_SetString(exceptions->numerical.ptr(), error.what());
  } catch (const Failure& error) {
    PyErr_SetString(exceptions->failure.ptr(), error.what());
  }
}

// Lets Python see Ctrl-C, some fifty times a second. It comes to the main thread; workers never wait
// for the lock here, which a caller that waits for them may hold.
void LookForSignals() {
  if (gettid() != getpid()) return;
  using Clock = std::chrono::steady_clock;
  static thread_local Clock::time_point looked{};
  const auto now = Clock::now();
  if (now - looked < std::chrono::milliseconds(20)) return;
  looked = now;
  const py::gil_scoped_acquire lock;
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

}  // namespace

void BindFailure(py::module_& m) {
  const py::object base = py::reinterpret_borrow<py::object>(PyExc_RuntimeError);
  const py::object failure = MakeException(
      m, "Failure", "What abbe cannot do; the text says what happened, where, and what to do next.",
      base);
  const py::tuple wrong_value =
      py::make_tuple(failure, py::reinterpret_borrow<py::object>(PyExc_ValueError));
  exceptions = new Exceptions{
      failure, MakeException(m, "InputError", "A bad file or a bad value.", wrong_value),
      MakeException(m, "DeviceError", "A device or the system failed.", failure),
      MakeException(m, "NumericalError", "A computation without a usable result.", failure)};
  py::register_exception_translator(&Translate);
  AskBetweenSteps(&LookForSignals);
}

}  // namespace abbe::python
