// The three ways in which abbe fails. The program maps them to exit codes 2, 3 and 4 and prints
// what() as one line on standard error, so a message says what happened, where, and what to do
// next.
#pragma once

#include <stdexcept>
#include <string>

namespace abbe {

class Failure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// A bad file or a bad value. The message names the file, the line and the key or column where they
// are known, and what was expected.
class InputError : public Failure {
 public:
  using Failure::Failure;
};

// A device that failed or did not answer. The message names the device, its answer and what was
// tried.
class DeviceError : public Failure {
 public:
  using Failure::Failure;
};

// A computation without a usable result: no convergence, or a singular problem. The message names
// the quantity and the condition that failed.
class NumericalError : public Failure {
 public:
  using Failure::Failure;
};

}  // namespace abbe
