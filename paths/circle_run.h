// A circular test as measured: points in the plane of the circle, both senses.
//
//   std::vector<CircleRun> runs = CircleRuns({path_cw, path_ccw}, {.plane = "XY"});
//   const CircleFigures figures = EvaluateCircle(runs.front(), {.cutoff = 50.0});
//
// Paths of one instrument, plane, radius, centre and feed form one run, also from several
// recordings. The plane is that of the options, else of the header, else that of the commanded
// path: XY, YZ, ZX, or "inclined". Counter-clockwise is from the first axis towards the second; the
// sense is that of the commanded path, not of the column `direction`. Rows off the commanded circle
// (run-in and run-out) and at rest (direction 0) are left out.
//
// The nominal radius is the programmed one, of the options or else of the header
// (MeasuredPath::radius). Without either it is the least-squares radius of the recorded positions.
// These may be readings of the scales, whose circle is smaller than the programmed one by the lag
// of the servos: D, F_max and F_min are then not figures of the standard (is_programmed).
//
// Frames: `first`, `second` and `third` are coordinates from the commanded centre, along the axes
// of the plane and its normal. Units: m, rad, m/s. Shapes: one entry a point.
// Failure: InputError with the recording for a path that is no circle, a sense with less than a
// quarter of it, a plane that is not two axes, or coordinates that were not measured.
// Source: ISO 230-4. Validity: a programmed radius within kLikeCommanded of the recorded one. For a
// part of the circle (Partial) the figures are those of the arc, without D, which is a mean over
// whole turns, and without harmonics.
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
  double radius = 0.0;                  // m, nominal
  Eigen::Vector3d centre;               // m, axis coordinates
  double feed = 0.0;                    // m/s
  std::optional<double> u_length = {};  // m: of a calibrated ballbar
  bool third_seen = false;
  bool is_programmed = false;       // the nominal radius; else it is that of the recorded positions
  std::vector<CirclePoint> points;  // in the order of time, recording after recording
  std::size_t left_out = 0;         // rows off the circle, at rest, or with a flag
  // m: the least-squares centre of the measured circle from the commanded centre; for a part of the
  // circle that of a circle with the nominal radius.
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();

  // rad: the turn without gaps between points that are much wider than the others are.
  double Covered(int sense) const;
  bool Has(int sense) const;
  bool Partial() const;  // a measured sense is not a whole turn
};

struct CircleOptions {
  std::string plane;    // empty: see above
  double radius = 0.0;  // m; 0: see above
};

std::vector<CircleRun> CircleRuns(const std::vector<MeasuredPath>& paths,
                                  const CircleOptions& options = {});

// Largest relative difference between the programmed and the recorded radius; beyond it the
// programmed one belongs to another circle. A lag of 30 ms at 5 m/min is 0.8 % of 20 mm.
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

// The run with its radius filtered; unchanged for a cutoff of 0.
CircleRun Filtered(const CircleRun& run, double cutoff);

CircleFigures EvaluateCircle(const CircleRun& run, const FigureOptions& options = {});

}  // namespace abbe::paths
