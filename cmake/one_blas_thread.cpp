// Before main: OpenBLAS works in one thread. abbe divides its work itself, so that sums are the
// same to the last bit on any number of cores. An OpenBLAS that was built without threads at all
// has one set of buffers, which two callers would overwrite for each other without a sign: that one
// is refused.
#include <cstdio>
#include <cstdlib>

extern "C" {
int openblas_get_parallel();
void openblas_set_num_threads(int count);
}

namespace {

bool UseOneThread() {
  if (openblas_get_parallel() == 0) {
    std::fputs(
        "abbe: the OpenBLAS of this machine was built without threads, and must not be called "
        "from several; install libopenblas0-pthread (or choose it, where both are there: "
        "update-alternatives --config libopenblas.so.0-x86_64-linux-gnu)\n",
        stderr);
    std::_Exit(2);
  }
  openblas_set_num_threads(1);
  return true;
}

[[maybe_unused]] const bool kOneThread = UseOneThread();

}  // namespace
