#include "rig/record_ballbar.h"

#include <fmt/format.h>

#include <utility>

#include "rig/noise.h"
#include "rig/streams.h"
#include "settings/unit.h"

namespace abbe::rig {

using Eigen::Vector3d;
using recording::Recording;
using settings::kMillimetre;

namespace {

constexpr double kSetUp = 20e-6, kLonger = 5e-6;  // m, of a normal distribution

Vector3d RowOf(const Recording& recording, const char* prefix, std::size_t row) {
  Vector3d values;
  for (int axis = 0; axis < kAxes; ++axis) {
    values[axis] = recording.At(fmt::format("{}{}_mm", prefix, "xyz"[axis]))[row];
  }
  return kMillimetre * values;
}

bool IsKept(const std::string& column) {
  return !column.starts_with("ref_") && column != "x_mm" && column != "y_mm" && column != "z_mm";
}

}  // namespace

Recording RecordBallbar(const LinkageRig& rig, const Course& course, const BallbarProgram& program,
                        CourseOptions options) {
  const std::uint64_t seed = rig.world().seed(), run = options.run;
  const Vector3d ball =
      program.centre + WhiteNoise(seed, kBallbarStream + kRunStreams * run, kSetUp).At(0);
  const double longer = WhiteNoise(seed, kBallbarStream, kLonger).At(0)[0];
  options.kind = "reference";
  options.keys += fmt::format("axis = \"{}\"\ncentre_mm = [{:.9g}, {:.9g}, {:.9g}]\n",
                              program.plane, program.centre[0] / kMillimetre,
                              program.centre[1] / kMillimetre, program.centre[2] / kMillimetre);
  options.tables += "[mounting]\nballbar = \"rig\"\n";
  const Recording places = rig.Record(course, options);
  Recording circle;
  circle.name = fmt::format("rig ballbar, seed {}", seed);
  circle.header = places.header;
  const std::string_view kind = "kind = \"reference\"";
  circle.header.replace(circle.header.find(kind), kind.size(), "kind = \"ballbar\"");
  for (const recording::Column& column : places.columns) {
    if (IsKept(column.name)) circle.columns.push_back(column);
  }
  std::vector<recording::Column> added{{"x_mm", {}}, {"y_mm", {}}, {"z_mm", {}}};
  recording::Column radius{"ref_radius_mm", {}};
  const int across = 3 - (program.plane[0] - 'X') - (program.plane[1] - 'X');
  for (std::size_t row = 0; row < places.rows(); ++row) {
    Vector3d at = RowOf(places, "", row) - program.centre;
    at[across] = 0.0;
    at *= program.radius / at.norm();
    for (int axis = 0; axis < kAxes; ++axis) added[axis].values.push_back(at[axis] / kMillimetre);
    const double length = (RowOf(places, "ref_", row) - ball).norm() - longer;
    radius.values.push_back(length / kMillimetre);
  }
  added.push_back(std::move(radius));
  circle.columns.insert(circle.columns.begin() + 1, added.begin(), added.end());
  return circle;
}

}  // namespace abbe::rig
