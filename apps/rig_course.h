// The course of `abbe rig --course` and `abbe rig record --course` from the command line: the
// path of the machine under the linkage.
//
// A course is the name of a standard one or a file for paths/nominal_path.h. Its default centre is
// the middle of the travels. Failure: InputError in one line for an unknown course, a wrong size, a
// position outside a travel or out of the reach of the linkage.
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
  double cap_force_n = 0.0;  // N; 0: that of the machine file
  std::uint64_t run = 1;
};

// The options of the path, and those of its recording.
void AddCourseOptions(CLI::App& command, CourseRequest& request);
void AddRecordingOptions(CLI::App& command, CourseRequest& request);

rig::Course CourseOf(const CourseRequest& request, const rig::RigSettings& machine);

recording::Recording RecordCourse(const rig::LinkageRig& rig, const CourseRequest& request,
                                  double rate, const std::string& started);

}  // namespace abbe::apps
