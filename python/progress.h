// Long calls: without the lock of the interpreter, with progress for a function of Python.
//
//   Long(progress, [&] { return fusion::FuseSources(sources, instruments, options); });
//
// Failure: what the function of Python throws ends the work and reaches the caller.
#pragma once

#include <optional>
#include <string>

#include "bindings.h"
#include "failure/progress.h"

namespace abbe::python {

// progress(done, total, what); None: nobody asks.
using Asks = std::optional<py::function>;

template <typename Work>
auto Long(const Asks& progress, const Work& work) {
  const WithoutLock without_lock;
  if (!progress) return work();
  const ProgressTo to([&](std::size_t done, std::size_t total, const std::string& what) {
    const py::gil_scoped_acquire lock;
    (*progress)(done, total, what);
  });
  auto result = work();
  to.End();
  return result;
}

}  // namespace abbe::python
