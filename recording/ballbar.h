// A circle measured by a ballbar, from a table of radius by angle, as a recording of kind
// "ballbar".
//
//   BallbarOf(table, {.radius_mm = 150.0, .plane = "XY", .feed_mm_min = 1000.0});
//
// The table has angle_deg, where the machine was commanded to, counter-clockwise from the first
// axis of the plane, in the order of measurement (descending angles are a clockwise circle), and
// deviation_um (radius less the nominal one) or ref_radius_mm. The recording has the commanded
// positions from the centre of the ballbar (x_mm, y_mm in XY), pass (a new one where the circle
// turns round), ref_radius_mm, feed_mm_min, temperatures and flags; its header says where the centre
// was, which a map and a diagnosis need (simulation/ballbar). Nothing is known along the circle and
// across its plane: kinds of evaluation that need it refuse a ballbar.
// Failure: InputError with the name of the table for a plane that is not two axes, a radius that is
// not above 0, a centre that is not three numbers, and columns that it lacks.
#pragma once

#include <string>
#include <vector>

#include "recording/recording.h"

namespace abbe::recording {

struct BallbarCircle {
  double radius_mm = 0.0;  // nominal: programmed
  std::string plane = "XY";
  double feed_mm_min = 0.0;            // 0: not stated
  std::vector<double> centre_mm = {};  // [x y z] of the axes with the tool at the centre ball
  std::string ballbar = {};            // its name, the same for all its circles
  double u_length_um = 0.0;            // of its calibrated length; 0: not calibrated
};

// `table`: angle_deg, with deviation_um or ref_radius_mm.
Recording BallbarOf(const Recording& table, const BallbarCircle& circle);

}  // namespace abbe::recording
