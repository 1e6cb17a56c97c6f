// Whether the address sanitizer watches the program. It takes terabytes of address space, and its
// locks do not survive a fork among threads: what limits the memory of a process, and what forks,
// asks ABBE_ADDRESS_SANITIZER, 1 or 0.
// Units: none. Failure: none.
// Validity: g++ and clang.
#pragma once

#if defined(__SANITIZE_ADDRESS__)
#define ABBE_ADDRESS_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define ABBE_ADDRESS_SANITIZER 1
#endif
#endif
#ifndef ABBE_ADDRESS_SANITIZER
#define ABBE_ADDRESS_SANITIZER 0
#endif
