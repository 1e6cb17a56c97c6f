// What is left of the data after all causes: structure that no known cause explains.
//
//   const std::vector<Found> found = FindStructures(fit);
//   for (const Leftover& leftover : LeftoversOf(fit, found)) ...       // nothing: all is explained
//
// Each channel is asked of each recorded variable whether a structure (structure.h) would make the
// channel fit better, free of everything that the simulation could be instead (fit.h): a smooth
// function, the strongest line of up to kLines wave numbers, the strongest interval (scan.h).
// What it then explains is chi-square distributed when nothing is there; the strongest line or
// interval counts as one of so many. Reported is the strongest answer of each channel whose
// probability, times the number of questions asked, is below `kDoubt`; the strongest first.
// Source: score test, Rao (1948).
#pragma once

#include <string>
#include <vector>

#include "diagnosis/evidence.h"
#include "diagnosis/fit.h"
#include "diagnosis/structure.h"
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
inline constexpr const char* kScatter = "scatter";  // of scatter.h
inline constexpr const char* kMemory = "memory";

// What the data say of a structure.
struct Found {
  Structure structure;
  double chi_square = 0.0;
  int freedom = 0;
  double length = 0.0;           // of the coefficients, m or rad
  double log_probability = 0.0;  // of as much by chance, the strongest of so many
  // The coefficients as draws: their deviation, and the evidence against nothing, among so many.
  DrawnSize drawn{0.0, 0.0};
};

// All structures that are asked for, the least probable by chance first.
std::vector<Found> FindStructures(const Fit& fit);
Found Asked(const Fit& fit, const Structure& structure);
// The borders of an interval, the number of terms of a smooth function at which most is explained.
Found Refined(const Fit& fit, Found found);

std::vector<Leftover> LeftoversOf(const Fit& fit, const std::vector<Found>& found);
Leftover LeftoverOf(const Fit& fit, const Found& found, std::size_t questions);

}  // namespace abbe::diagnosis
