// What is left of the data after all causes: structure that no known cause explains.
//
//   for (const Leftover& leftover : FindLeftovers(fit)) ...       // nothing: all is explained
//
// Each channel (the readings of a probe or of a sensor at a shaft, the angle of a pivot, the
// positioning of an axis) is asked of each recorded variable (time, the position of an axis and
// sums of two, the angle of a pivot or a shaft, a temperature, the feed) whether
//   a smooth function of it, kTerms cosines over its range, or
//   a line of its periodogram, sine and cosine of one of up to kLines wave numbers, or
//   an interval of it, a part of its range where the channel stands apart from the rest (scan.h),
// would make the channel fit better, free of everything that the simulation could be instead
// (fit.h). What it then explains is chi-square distributed when nothing is there; of a
// periodogram the strongest line counts, and of all intervals the strongest, as one of so many.
// Reported is the strongest answer of each channel whose probability, times the number of questions
// asked, is below `kDoubt`; the strongest first.
// Source: score test, Rao (1948).
#pragma once

#include <string>
#include <vector>

#include "diagnosis/fit.h"
#include "estimation/parameter.h"

namespace abbe::diagnosis {

struct Leftover {
  std::string variable;  // "time", "x", "x+y", "pivot_2", "shaft", "temp_table_c", "feed"
  std::string object;    // channel
  // m or rad, rms over the rows; of an interval, how far apart; of a scatter, in units of the noise
  double amplitude = 0.0;
  estimation::PrintUnit unit;
  double p_value = 1.0;         // corrected for the number of questions
  double period = 0.0;          // of a line, in the unit of the variable (s, m, rad); 0: none
  double from = 0.0, to = 0.0;  // of an interval, in that unit too
};

inline constexpr double kDoubt = 1e-3;
inline constexpr const char *kScatter = "scatter", *kMemory = "memory";  // of scatter.h

std::vector<Leftover> FindLeftovers(const Fit& fit);

}  // namespace abbe::diagnosis
