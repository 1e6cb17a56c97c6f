// The order in which the lines of an NC program act: loops, branches, subroutines.
//
//   RunProgram(source, parameters, host);
//
// The host gets every line that acts, in order, with loops and calls written out. Limits: kLevels
// of calls, as in LinuxCNC, and NcHost::MostSteps() lines in all, after which a loop is taken for
// endless. Failure: InputError with the line (and the file, for a subroutine of another one), also
// for a way that depends on a value that is known only at the control.
// Source: LinuxCNC 2.9, O codes. Validity: ways by known values; an `if` by a value that the
// control alone knows is kept for it where the host can keep what stands in it (nc_kept.h).
// Units: conditions as the program writes them.
#pragma once

#include <cstddef>
#include <string_view>

#include "compensation/nc_parameters.h"
#include "compensation/nc_source.h"

namespace abbe::compensation {

inline constexpr std::size_t kLevels = 9;  // of calls

class NcHost {
 public:
  virtual ~NcHost() = default;
  // The next line that acts; false: the program has ended.
  virtual bool Take(std::string_view line, std::size_t line_number) = 0;
  // Whether a block that begins with / is left out; InputError where that is not known.
  virtual bool Deletes(std::size_t /*line_number*/) { return false; }
  // A line in a branch that is kept, whether or not the control takes it; InputError for one after
  // which the way that was taken matters. `is_last`: up to the end of the subroutine.
  virtual void TakeKept(std::string_view line, std::size_t line_number, bool is_last) = 0;
  // A line of the kept structure itself.
  virtual void WriteKept(std::string_view line) = 0;
  // A subroutine begins and ends.
  virtual void Enter() {}
  // The end of it, with the line of its return.
  virtual void Leave(std::size_t /*line_number*/) {}
  // Lines in all, after which a loop is taken for endless.
  virtual std::size_t MostSteps() const { return 20'000'000; }
};

// Hands the lines of `source` to `host` in the order in which they act.
void RunProgram(NcSource& source, NcParameters& parameters, NcHost& host);

}  // namespace abbe::compensation
