// Figures, curves and findings of a measurement, as a history compares and follows them.
//
// A figure has a name: the object it belongs to, a dot and the quantity with its unit at the end
// ("EYX.straightness_um", "XY.circularity_um", "X.positioning_A_um", "volumetric_um").
//
// Units: like the columns of a recording, values stay in the unit at the end of the name; curves in
// `unit`, over positions in mm. u is a standard uncertainty, U95 = coverage * u.
//
// Frames: positions along the axis as the control counts. Shapes: of a curve, one value a position,
// and one u a position or none.
//
// Shared uncertainty: `shares` are parts of the variance u^2, by the instrument that causes them
// ("head", "mounting", "target", "linkage", "length"). Two measurements with the same instrument
// have that part in common; what remains of the variance belongs to one measurement alone.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "standards/coverage.h"

namespace abbe::history {

using Shares = std::map<std::string, double>;  // instrument -> part of the variance, 0 to 1

// The stations of a sweep along its axis.
struct Stations {
  char axis = 'X';
  double first_mm = 0.0, last_mm = 0.0;
  int planned = 0, missing = 0;  // 0: the result does not say
};

struct Figure {
  std::string object;      // "EYX", "C0Y", "XY", "X", "linkage"; empty: of the whole machine
  std::string quantity;    // "straightness_um"
  std::string conditions;  // figures with others are of another test: "linkage, R 20 mm, F 300"
  double value = 0.0;
  std::optional<double> u{};  // none: the result states none
  double coverage = standards::kCoverage;
  Shares shares{};
  std::optional<Stations> stations{};  // of a sweep

  std::string Name() const { return object.empty() ? quantity : object + "." + quantity; }
  double U95() const { return coverage * u.value_or(0.0); }
};

struct Curve {
  std::string object;  // "EYX"
  std::string unit;    // "um" or "urad"
  std::string conditions;
  std::vector<double> positions_mm, value, u;  // u: one a position, or none
  double coverage = standards::kCoverage;
  Shares shares{};
};

struct Finding {
  std::string cause, object;  // "backlash", "X"
  double probability = 0.0;
};

// Whether a quantity has a sign, so that its limit holds for both sides (squareness, reversal,
// scale); others are ranges and are never negative.
bool IsSigned(const std::string& quantity);

}  // namespace abbe::history
