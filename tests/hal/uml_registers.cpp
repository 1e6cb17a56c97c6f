// Preloaded into User-Mode Linux by uml_run: registers of a guest's process on a processor that has
// more of them than the guest's kernel keeps room for (AMX).
//
// Such a kernel writes back the part of the extended registers that it read; the host takes all of
// them or none. Here the rest is added as it stands.
#include <dlfcn.h>
#include <elf.h>
#include <sys/ptrace.h>
#include <sys/types.h>
#include <sys/uio.h>

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdint>
#include <cstring>

extern "C" long ptrace(enum __ptrace_request request, ...) {
  va_list arguments;
  va_start(arguments, request);
  const auto process = va_arg(arguments, pid_t);
  auto* const address = va_arg(arguments, void*);
  auto* const data = va_arg(arguments, void*);
  va_end(arguments);
  using Ptrace = long (*)(int, pid_t, void*, void*);
  static const auto of_library = reinterpret_cast<Ptrace>(dlsym(RTLD_NEXT, "ptrace"));
  const long done = of_library(request, process, address, data);
  const bool extended = reinterpret_cast<std::uintptr_t>(address) == NT_X86_XSTATE;
  if (done == 0 || request != PTRACE_SETREGSET || !extended) return done;
  alignas(64) static std::array<char, 65536> registers;
  iovec all{registers.data(), registers.size()};
  if (of_library(PTRACE_GETREGSET, process, address, &all) != 0) return -1;
  const auto* part = static_cast<const iovec*>(data);
  std::memcpy(registers.data(), part->iov_base, std::min(part->iov_len, all.iov_len));
  return of_library(PTRACE_SETREGSET, process, address, &all);
}
