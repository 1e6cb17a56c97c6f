#include "apps/rig_course.h"

#include <fmt/format.h>

#include <filesystem>
#include <numeric>

#include "failure/failure.h"
#include "paths/nominal_path.h"
#include "rig/record_ballbar.h"
#include "settings/unit.h"

namespace abbe::apps {
namespace {

using Eigen::Vector3d;

constexpr int kMostPlaces = 1'000'000;

// The size of a course in m: as given, or `usual` in mm. One number applies to all.
std::vector<double> SizeOf(const CourseRequest& request, const std::vector<double>& usual) {
  std::vector<double> size = request.size_mm.empty() ? usual : request.size_mm;
  if (size.size() == 1) size.assign(usual.size(), size.front());
  if (size.size() != usual.size()) {
    throw InputError(fmt::format("--size: {} numbers, but the course {} has {}", size.size(),
                                 request.course, usual.size()));
  }
  for (double& each : size) each *= settings::kMillimetre;
  return size;
}

std::vector<int> PointsOf(const CourseRequest& request, const std::vector<int>& usual) {
  if (request.points.empty()) return usual;
  if (request.points.size() != usual.size()) {
    throw InputError(fmt::format("--points: {} numbers, but the course {} has {}",
                                 request.points.size(), request.course, usual.size()));
  }
  return request.points;
}

Vector3d CentreOf(const CourseRequest& request, const rig::RigSettings& machine) {
  Vector3d centre;
  for (int axis = 0; axis < rig::kAxes; ++axis) {
    const auto [first, last] = machine.travels[axis];
    centre[axis] = request.centre_mm.empty() ? std::midpoint(first, last)
                                             : request.centre_mm[axis] * settings::kMillimetre;
  }
  return centre;
}

// The axis normal to a plane: 'Y' for "ZX".
char NormalOf(const std::string& plane) { return plane == "XY" ? 'Z' : plane == "YZ" ? 'X' : 'Y'; }

rig::Course FromFile(const CourseRequest& request, double feed) {
  if (!std::filesystem::exists(request.course)) {
    throw InputError(
        fmt::format("--course {}: no course of this name and no such file; give cube, circle, "
                    "stepping, square or a CSV file with x_mm,y_mm,z_mm",
                    request.course));
  }
  const Eigen::Matrix3Xd path = paths::ReadNominalPath(request.course);
  std::vector<Vector3d> points;
  for (Eigen::Index i = 0; i < path.cols(); ++i) points.emplace_back(path.col(i));
  return rig::LineCourse(points, feed, 0.0, 1);
}

double RadiusOf(const CourseRequest& request) { return 0.5 * SizeOf(request, {40.0}).front(); }

// The header keys that a course adds to its recording.
std::string KeysOf(const CourseRequest& request) {
  if (request.course != "circle") return "";
  return fmt::format("radius_mm = {:.9g}\n", RadiusOf(request) / settings::kMillimetre);
}

rig::Course Planned(const CourseRequest& request, const rig::RigSettings& machine) {
  const Vector3d centre = CentreOf(request, machine);
  const double feed = request.feed_mm_min * settings::kMillimetrePerMinute;
  const char normal = NormalOf(request.plane);
  if (request.course == "cube") {
    const std::vector<double> size = SizeOf(request, {25.0, 25.0, 50.0});
    const std::vector<int> points = PointsOf(request, {7, 7, 12});
    if (1.0 * points[0] * points[1] * points[2] > kMostPlaces) {
      throw InputError(fmt::format("--points {},{},{}: makes more than {} positions; take fewer",
                                   points[0], points[1], points[2], kMostPlaces));
    }
    return rig::DwellCourse(
        rig::GridPlaces(centre, {size[0], size[1], size[2]}, {points[0], points[1], points[2]}),
        feed, request.dwell_s, 1);
  }
  if (request.course == "circle") {
    return rig::CircleCourse({normal, centre, RadiusOf(request), feed, request.passes});
  }
  if (request.course == "stepping") {
    const double length = SizeOf(request, {25.0}).front();
    const int steps = PointsOf(request, {6}).front() - 1;
    const Vector3d start = centre - Vector3d::Constant(0.5 * length);
    return rig::DwellCourse(rig::SteppingPlaces(start, length / steps, steps), feed,
                            request.dwell_s, 1);
  }
  if (request.course == "square") {
    return rig::SquareCourse(
        {normal, centre, SizeOf(request, {40.0}).front(), feed, request.passes});
  }
  return FromFile(request, feed);
}

void RefuseBeyondTravels(const rig::Course& course, const rig::RigSettings& machine,
                         const std::string& name) {
  constexpr double kRounding = 1e-9;  // m
  const auto check = [&](const Vector3d& point) {
    for (int axis = 0; axis < rig::kAxes; ++axis) {
      const auto [first, last] = machine.travels[axis];
      if (point[axis] >= first - kRounding && point[axis] <= last + kRounding) continue;
      throw InputError(fmt::format(
          "--course {}: reaches {} {:g} mm, beyond the travel of {:g} to {:g} mm in {}; choose "
          "another --size or --centre",
          name, static_cast<char>('X' + axis), 1e3 * point[axis], 1e3 * first, 1e3 * last,
          machine.name));
    }
  };
  check(course.start);
  for (const rig::Move& move : course.moves) {
    for (const Vector3d& point : move.points) check(point);
  }
}

}  // namespace

rig::Course CourseOf(const CourseRequest& request, const rig::RigSettings& machine) {
  rig::Course course = Planned(request, machine);
  RefuseBeyondTravels(course, machine, request.course);
  return course;
}

void AddCourseOptions(CLI::App& command, CourseRequest& request) {
  command.add_option(
      "--course", request.course,
      "Path under the linkage: cube, circle, stepping, square, or a CSV file of points");
  command.add_option("--centre", request.centre_mm, "X,Y,Z in mm (default: middle of the travels)")
      ->delimiter(',')
      ->expected(3);
  command
      .add_option("--size", request.size_mm,
                  "mm: edges of the cube (25,25,50), diameter (40), length of the stepping line "
                  "(25), side of the square (40)")
      ->delimiter(',')
      ->expected(1, 3)
      ->check(PositiveNumber());
  command
      .add_option("--points", request.points,
                  "Points of the cube along each axis (7,7,12), or of a stepping line (6)")
      ->delimiter(',')
      ->expected(1, 3)
      ->check(CLI::Range(2, 1000));
  command.add_option("--plane", request.plane, "Plane of the circle or the square")
      ->check(CLI::IsMember({"XY", "YZ", "ZX"}))
      ->capture_default_str();
  command.add_option("--feed", request.feed_mm_min, "mm/min")
      ->check(PositiveNumber())
      ->capture_default_str();
  command.add_option("--dwell", request.dwell_s, "Dwell at each position of cube or stepping, s")
      ->check(PositiveNumber())
      ->capture_default_str();
  command.add_option("--passes", request.passes, "Passes of circle or square, in each sense")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command.add_option("--cap-force", request.cap_force_n, "Force of the magnet in the tool cap, N")
      ->check(PositiveNumber());
}

void AddRecordingOptions(CLI::App& command, CourseRequest& request) {
  command
      .add_option("--kind", request.kind,
                  "Instrument: linkage, grid encoder (reference), or ballbar")
      ->check(CLI::IsMember({"linkage", "reference", "ballbar"}))
      ->capture_default_str();
  command.add_flag("--reference", request.reference,
                   "Record the grid encoder too, in the same recording");
  command.add_option("--run", request.run, "Number of the run; each has its own noise")
      ->capture_default_str();
}

recording::Recording RecordCourse(const rig::LinkageRig& rig, const CourseRequest& request,
                                  double rate, const std::string& started) {
  const rig::Course course = CourseOf(request, rig.world().settings());
  const rig::CourseOptions options{.kind = request.kind,
                                   .reference = request.reference,
                                   .rate = rate,
                                   .cap_force = request.cap_force_n,
                                   .run = request.run,
                                   .started = started,
                                   .keys = KeysOf(request)};
  if (request.kind != "ballbar") return rig.Record(course, options);
  if (request.course != "circle" || request.reference) {
    throw InputError("--kind ballbar: a ballbar measures circles, alone; give --course circle");
  }
  return rig::RecordBallbar(rig, course,
                            {.plane = request.plane,
                             .centre = CentreOf(request, rig.world().settings()),
                             .radius = RadiusOf(request)},
                            options);
}

}  // namespace abbe::apps
