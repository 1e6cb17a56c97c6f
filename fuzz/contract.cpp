#include "fuzz/contract.h"

#include <sys/resource.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "failure/failure.h"
#include "failure/sanitized.h"

#if ABBE_ADDRESS_SANITIZER
// Part of the sanitizers' runtime; their header does not come with every compiler.
extern "C" {
int __sanitizer_install_malloc_and_free_hooks(void (*taken)(const volatile void*, std::size_t),
                                              void (*given)(const volatile void*));
std::size_t __sanitizer_get_allocated_size(const volatile void* memory);
}
#endif

namespace abbe::fuzz {
namespace {

// Blocks that libraries and readers keep whatever the size of the file (a line's 1 MiB, caches of
// HDF5, the page of a report), and what a byte of a file may become: a node of a parsed tree.
constexpr std::size_t kAnyway = std::size_t{48} << 20, kPerByte = 400;

std::size_t Allowed(Bytes bytes) { return kAnyway + kPerByte * bytes.size(); }

[[noreturn]] void Refuse(const char* what, Bytes bytes, std::size_t number) {
  std::fprintf(stderr, "does not hold: %s (%zu bytes for a file of %zu)\n", what, number,
               bytes.size());
  std::abort();
}

#if ABBE_ADDRESS_SANITIZER

std::atomic<std::int64_t> held{0};
std::atomic<std::int64_t> allowed{INT64_MAX};

void CountTaken(const volatile void*, std::size_t size) {
  if ((held += static_cast<std::int64_t>(size)) > allowed.load()) {
    allowed = INT64_MAX;
    std::fprintf(stderr,
                 "does not hold: memory is bounded by the size of the file (%zu bytes asked)\n",
                 size);
    std::abort();
  }
}

void CountGiven(const volatile void* memory) {
  if (memory == nullptr) return;
  held -= static_cast<std::int64_t>(__sanitizer_get_allocated_size(memory));
}

class MemoryBound {
 public:
  explicit MemoryBound(Bytes bytes) {
    static const bool counts =
        __sanitizer_install_malloc_and_free_hooks(CountTaken, CountGiven) != 0;
    Require(counts, "allocations can be counted");
    held = 0;
    allowed = static_cast<std::int64_t>(Allowed(bytes));
  }
  ~MemoryBound() { allowed = INT64_MAX; }
};

#else

// The most that the program ever held, in bytes.
std::size_t MostHeld() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss * 1024;
}

class MemoryBound {
 public:
  explicit MemoryBound(Bytes bytes) : bytes_(bytes), before_(MostHeld()) {
    // Where a reader asks for all there is, it alone shall fail.
    const rlimit most{std::size_t{4} << 30, std::size_t{4} << 30};
    setrlimit(RLIMIT_DATA, &most);
  }
  ~MemoryBound() {
    const std::size_t more = MostHeld() - before_;
    if (more > Allowed(bytes_)) Refuse("memory is bounded by the size of the file", bytes_, more);
  }

 private:
  Bytes bytes_;
  std::size_t before_;
};

#endif

// A message is one line, and it says something.
void CheckMessage(const char* message, Bytes bytes) {
  const std::size_t size = std::strlen(message);
  if (size == 0 || std::strchr(message, '\n') != nullptr) {
    std::fprintf(stderr, "message: \"%s\"\n", message);
    Refuse("a message is one line", bytes, size);
  }
}

}  // namespace

void HoldContract(Reader read, Bytes bytes) {
  const MemoryBound bound(bytes);
  try {
    read(bytes);
  } catch (const InputError& failure) {
    CheckMessage(failure.what(), bytes);
  }
}

}  // namespace abbe::fuzz
