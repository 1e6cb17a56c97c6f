// What every reader owes its user, whatever the file: it reads it, or throws an InputError of one
// line; it ends; its memory is bounded by the size of the file.
//
//   HoldContract(hole_table::Read, bytes);
//
// Ends the program with a line on standard error where the contract is broken, so that fuzzer and
// sanitizers see a crash. Memory is counted where a sanitizer sees every allocation, else by what
// the program holds at most; the time is the caller's to bound.
#pragma once

#include "fuzz/target.h"

namespace abbe::fuzz {

using Reader = void (*)(Bytes);

void HoldContract(Reader read, Bytes bytes);

}  // namespace abbe::fuzz
