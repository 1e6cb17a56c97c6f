// The structures that the data show beside a fit, strongest first.
//
//   const std::vector<Found> found = FindStructures(fit);
//   const std::vector<Leftover> left = LeftoversOf(fit, found);       // empty: all is explained
//
// Each channel is asked of each recorded variable whether a structure (structure.h) would make the
// channel fit better, free of everything that the simulation could be instead (fit.h): a smooth
// function, the strongest line of up to kLines wave numbers, the strongest interval (scan.h), a
// product. What it then explains is chi-square distributed when nothing is there; the strongest
// line or interval counts as one of so many. A leftover is the strongest answer of each channel
// whose probability, times the number of questions asked, is below `kDoubt`.
// Units: SI. Shapes: one row of a projection for each term of a structure. Validity: to first
// order at the fit. Source: score test, Rao (1948).
#pragma once

#include <vector>

#include "diagnosis/evidence.h"
#include "diagnosis/fit.h"
#include "diagnosis/structure.h"
#include "diagnosis/unexplained.h"

namespace abbe::diagnosis {

// What the data say of a structure.
struct Found {
  Structure structure;
  double chi_square = 0.0;
  int freedom = 0;
  double length = 0.0;           // of the coefficients, m or rad
  double log_probability = 0.0;  // of as much by chance, the strongest of so many
  // The coefficients as draws: their deviation, and the evidence against nothing, among so many.
  DrawnSize drawn{0.0, 0.0};
  // Other variables (and channels) with which the data go as well, within kAsGood.
  std::vector<Dependence> one_of = {};
};

inline constexpr double kAsGood = 3.0;  // in the logarithm of a probability: one of twenty

// Each of them once.
void AddAlike(const Structure& other, Found& found);

// All structures that are asked for, the least probable by chance first.
std::vector<Found> FindStructures(const Fit& fit);
// What the data say of one.
Found Explained(Structure structure, const Fit::Projection& projection);
Found Asked(const Fit& fit, const Structure& structure);
// The borders of an interval, the number of terms of a smooth function, the wave of a line at which
// most is explained.
Found Refined(const Fit& fit, Found found);

// For the report, each channel once, at most six; of one of so many questions.
std::vector<Leftover> LeftoversOf(const Fit& fit, const std::vector<Found>& found);
Leftover LeftoverOf(const Fit& fit, const Found& found, std::size_t questions);

}  // namespace abbe::diagnosis
