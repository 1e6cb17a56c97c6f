// Where a failure happened, said once: the file, the table or the option that a reader knows and
// the code that fails does not.
//
//   const map::ErrorMap found = Located(file, [&] { return map::MapOfTables(tables); });
//   // "maps/mill.isg: the table of an axis counts backwards"
//
// Frames, units, shapes: none.
// Failure: an InputError of `make` gets `where` and a colon before its words; others pass.
// Source: own. Validity: for makers that do not name the place themselves.
#pragma once

#include <string>
#include <string_view>

#include "failure/failure.h"

namespace abbe {

template <typename Make>
auto Located(std::string_view where, const Make& make) {
  try {
    return make();
  } catch (const InputError& failure) {
    throw InputError(std::string(where).append(": ").append(failure.what()));
  }
}

}  // namespace abbe
