// The figures of a circular test after ISO 230-4.
//
//   Circularity figures = EvaluateCircularity({.radius = 0.010, .cw = cw, .ccw = ccw});
//   figures.cw->G;  figures.both->G;  figures.F_max;  figures.D;
//
// Frames: x and y are the coordinates of the measured path in the plane of the test, from the
// nominal centre (the set-up centre). Counter-clockwise turns the first axis of the plane towards
// the second. Units: m. Shapes: the points of each sense in the order of the path, any number of
// turns; one sense may be absent (empty); figures that need both are then absent. In least-squares
// circles a point weighs the arc that it stands for, so gaps and standstills do not move them.
//   G(cw), G(ccw)  circular deviation: separation of the two concentric circles that enclose the
//                  path, minimum zone (G) and about the least-squares centre (G_ls)
//   G(b)           the same of both paths together
//   F_max, F_min   radial deviation: distance from the set-up centre minus the nominal radius; _ls:
//                  from the least-squares centre of both paths (the standard's second choice)
//   D              mean radius, least-squares circle of both paths, minus the nominal radius
// Failure: InputError as in standards/circle.h, with the sense named, for a radius that is not
// positive, or when both senses are empty. Source: ISO 230-4:2022, clause 3 (error, where the
// edition of 2005 said deviation); not checked against its text. Validity: the figures of the
// points as given: they grow with noise and the number of points. Filter first
// (closed_profile_filter.h) and state it, with radius, feed and plane.
#pragma once

#include <optional>
#include <vector>

#include "standards/circle.h"

namespace abbe::standards {

struct PlanePath {
  std::vector<double> x, y;
};

struct CircularPaths {
  double radius = 0.0;  // nominal
  PlanePath cw, ccw;
};

struct SenseFigures {
  double G = 0.0, G_ls = 0.0;
  Circle minimum_zone, least_squares;
  double F_max = 0.0, F_min = 0.0;
};

struct Circularity {
  std::optional<SenseFigures> cw, ccw;
  std::optional<SenseFigures> both;  // G(b): both senses measured
  double F_max = 0.0, F_min = 0.0;   // of all points
  double F_max_ls = 0.0, F_min_ls = 0.0;
  std::optional<double> D;
};

Circularity EvaluateCircularity(const CircularPaths& paths);

}  // namespace abbe::standards
