// What is left of the data after all causes: structure that no known cause explains. A channel
// depends on a recorded variable (structure_question.h), or a run scatters or remembers more than
// its noise does (scatter.h).
// Units: SI.
// Failure: none.
// Source: structure_question.h, scatter.h.
// Validity: a p-value is that of noise alone, corrected for all that was asked.
#pragma once

#include <string>
#include <vector>

#include "estimation/parameter.h"

namespace abbe::diagnosis {

// That a channel depends on a variable.
struct Dependence {
  std::string variable, object;

  friend bool operator==(const Dependence&, const Dependence&) = default;
};

struct Leftover {
  std::string variable;  // of simulation/variables.h
  std::string object;    // channel
  // m or rad, rms over the rows; of an interval, how far apart; of a scatter, in units of the noise
  double amplitude = 0.0;
  estimation::PrintUnit unit;
  double p_value = 1.0;         // corrected for the number of questions
  double period = 0.0;          // of a line, in the unit of the variable (s, m, rad); 0: none
  double from = 0.0, to = 0.0;  // of an interval, in that unit too
  // Others of which the runs tell as well that it may be they; empty: none.
  std::vector<Dependence> one_of = {};

  bool IsOfAnInterval() const { return to > from; }
};

inline constexpr double kDoubt = 1e-3;
inline constexpr const char* kScatter = "scatter";  // of scatter.h
inline constexpr const char* kMemory = "memory";
inline constexpr const char* kAtRest = "scatter at rest";  // of measured_noise.h

}  // namespace abbe::diagnosis
