// A circular test as an instrument saw it: points in the plane of the circle, both senses.
//
//   std::vector<CircleRun> runs = CircleRuns({path_cw, path_ccw}, {.plane = "XY"});
//   const CircleFigures figures = EvaluateCircle(runs.front(), {.cutoff = 50.0});
//
// Paths of one instrument, plane, radius, centre and feed are one run, in whatever recordings they
// stand. The plane is that of the options, else of the header, else that in which the commanded
// path lies: XY, YZ, ZX, or "inclined". Counter-clockwise turns the first axis towards the second,
// as the commanded path itself turns; the column `direction` is not needed. Left out are rows that
// do not lie on the commanded circle (run-in and run-out), and rests (direction 0).
// Frames: `first`, `second` and `third` are coordinates from the commanded centre, along the axes
// of the plane and its normal. Units: m, rad, m/s. Shapes: one entry a point.
// Failure: InputError with the recording for a path that is no circle, a sense with less than a
// quarter of it, a plane that is not two axes, or coordinates that the instrument lacks. Source:
// ISO 230-4. The nominal radius is the programmed one, of the options or else of the header
// (MeasuredPath::radius). Where neither says it, it is that of the positions in the recording
// (least squares): these may be scales, which a lagging servo leaves inside the programmed circle,
// so D, F_max and F_min are then no figures of the standard (is_programmed). Validity: a programmed
// radius within kLikeCommanded of the positions'; of a part of the circle (Partial) the figures are
// those of the arc, and D, which is a mean of whole turns, and harmonics are left out.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "paths/measured_path.h"
#include "standards/circularity.h"
#include "standards/harmonics.h"

namespace abbe::paths {

struct CirclePlane {
  std::string name;                      // "XY", ..., "inclined"
  Eigen::Vector3d first, second, third;  // unit vectors in axis coordinates
  bool Inclined() const { return name == "inclined"; }
};

struct CirclePoint {
  double first, second, third;  // m, from the commanded centre
  double angle;                 // rad, about the middle of the measured run
  int sense;                    // +1 counter-clockwise
  int pass;
};

struct CircleRun {
  std::vector<std::string> recordings;
  std::string instrument;
  CirclePlane plane;
  double radius = 0.0;     // m, nominal
  Eigen::Vector3d centre;  // m, axis coordinates
  double feed = 0.0;       // m/s
  bool third_seen = false;
  bool is_programmed = false;  // the nominal radius; false: it is that of the recorded positions
  std::vector<CirclePoint> points;  // in the order of time, recording after recording
  std::size_t left_out = 0;         // rows off the circle, at rest, or with a flag
  // m: where the measured circle has its centre, from the commanded one: least squares, for a part
  // of the circle with the nominal radius.
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();

  double Covered(int sense) const;  // rad of the circle that has points, counted in steps of 5 deg
  bool Has(int sense) const;
  bool Partial() const;  // a sense that was measured is not all around
};

struct CircleOptions {
  std::string plane;    // empty: see above
  double radius = 0.0;  // m; 0: see above
};

std::vector<CircleRun> CircleRuns(const std::vector<MeasuredPath>& paths,
                                  const CircleOptions& options = {});

// Of the radius: a programmed one that is further off from the recorded positions is another
// circle's. A lag of 30 ms at 5 m/min makes 20 mm smaller by 0.8 %.
inline constexpr double kLikeCommanded = 0.1;

struct CircleFigures {
  standards::Circularity iso;                     // D and F of the standard only if is_programmed
  std::optional<standards::HarmonicFit> cw, ccw;  // of the radius about the centre of each sense
  double out_of_plane = 0.0;                      // m: range of the third coordinate
  bool is_programmed = false;                     // as of the run
};

struct FigureOptions {
  double cutoff = 0.0;  // undulations a turn of the Gaussian filter; 0: as measured
  int harmonics = 10;
};

// The run with its radius filtered; as it is for a cutoff of 0.
CircleRun Filtered(const CircleRun& run, double cutoff);

CircleFigures EvaluateCircle(const CircleRun& run, const FigureOptions& options = {});

}  // namespace abbe::paths
