// The square path: four sides along two axes, evaluated like the sides of a workpiece.
//
// The sides are the rows whose commanded positions lie on the rectangle around all of them, away
// from its corners. On each side the measured positions are averaged over
// short pieces; a side's line is that of least squares (standards/reference_line.h).
//   straightness     of each side, least squares and minimum zone
//   length           between the corners where the lines of the sides meet, minus nominal
//   corner           angle between two neighbouring sides minus 90 degrees, inside the square
// Frames: axis coordinates, from the commanded centre. Units: m, rad. Shapes: sides in the order
// low second, high first, high second, low first (counter-clockwise from the lower side); corner i
// lies between side i and side i + 1. Failure: InputError with the recording for a commanded path
// that is no rectangle or a side without points. Source: ISO 230-1 for line and straightness;
// the path is the 125 mm square of the linkage's second paper.
// Validity: all passes and both senses together; give recordings of one sense for that sense alone.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "paths/measured_path.h"
#include "standards/straightness.h"

namespace abbe::paths {

struct SquareSide {
  char axis;                          // along which it runs
  std::vector<double> along, across;  // m: of the pieces, from the commanded centre; across
                                      // measured - commanded
  standards::Straightness least_squares, minimum_zone;
  double nominal = 0.0, length = 0.0;  // m; `length` is measured
};

struct SquareFigures {
  std::string plane;
  std::array<SquareSide, 4> sides;
  std::array<double, 4> corners{};  // rad
};

SquareFigures EvaluateSquare(const MeasuredPath& path);

}  // namespace abbe::paths
