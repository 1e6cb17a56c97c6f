// Before main of the programs of abbe: memory that was freed is kept for what comes next. The
// matrices of a fit come and go some thousand times; given back to the system each time, the pages
// of their memory cost two fifths of the time of a diagnosis. Not into libraries: how a process keeps
// its memory is its owner's to say.
#include <cstdlib>
#ifdef __GLIBC__
#include <malloc.h>

namespace {

bool KeepMemory() {
  constexpr int kLargestOfItsOwn = 32 << 20;  // bytes: the largest that mallopt takes
  constexpr int kKept = 512 << 20;
  return mallopt(M_MMAP_THRESHOLD, kLargestOfItsOwn) == 1 && mallopt(M_TRIM_THRESHOLD, kKept) == 1;
}

[[maybe_unused]] const bool kMemoryKept = KeepMemory();

}  // namespace
#endif
