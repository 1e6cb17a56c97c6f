// A circle under a ballbar on the rig: the distance of the tool from a ball that stands on the
// table.
//
//   const auto xy = RecordBallbar(rig, course, {.plane = "XY", .centre = c, .radius = 0.1});
//
// Kind "ballbar": positions from the centre of the circle as the bar knows them, at the programmed
// radius in the direction of the axes, and ref_radius_mm. The ball is set up beside its place by
// some 20 um, the bar is longer than it says by some 5 um, each drawn for the run or for the bar;
// noise is [linkage.noise] reference_um. Failure: that of LinkageRig::Record.
#pragma once

#include <Eigen/Core>
#include <string>

#include "recording/recording.h"
#include "rig/record_course.h"

namespace abbe::rig {

struct BallbarProgram {
  std::string plane = "XY";
  Eigen::Vector3d centre;  // m: the axes with the tool at the ball
  double radius = 0.1;     // m, programmed
};

// `options.kind` and `options.reference` do not count.
recording::Recording RecordBallbar(const LinkageRig& rig, const Course& course,
                                   const BallbarProgram& program, CourseOptions options = {});

}  // namespace abbe::rig
