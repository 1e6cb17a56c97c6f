// `abbe rig --course`, `abbe rig record --course`: which path the machine under the linkage runs,
// from the command line.
//
// A course is the name of a standard one or a file that paths/nominal_path.h reads. Without a centre
// it lies in the middle of the travels. Failure: InputError in one line for an unknown course, a
// size that does not fit it, a place beyond a travel or out of the linkage's reach.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "recording/recording.h"
#include "rig/record_course.h"

namespace abbe::apps {

struct CourseRequest {
  std::string course;  // cube, circle, stepping, square, or a file
  std::vector<double> centre_mm, size_mm;
  std::vector<int> points;
  std::string plane = "XY";
  double feed_mm_min = 600.0, dwell_s = 0.5;
  int passes = 1;
  std::string kind = "linkage";
  bool reference = false;
  double cap_force_n = 0.0;  // 0: that of the machine file
  std::uint64_t run = 1;
};

// What describes the path, and what a recording of it holds.
void AddCourseOptions(CLI::App& command, CourseRequest& request);
void AddRecordingOptions(CLI::App& command, CourseRequest& request);

rig::Course CourseOf(const CourseRequest& request, const rig::RigSettings& machine);

recording::Recording RecordCourse(const rig::LinkageRig& rig, const CourseRequest& request,
                                  double rate, const std::string& started);

}  // namespace abbe::apps
