#include "paths/measured_path.h"

#include <fmt/format.h>

#include <cmath>
#include <numeric>
#include <optional>
#include <span>

#include "failure/failure.h"
#include "recording/good_rows.h"
#include "settings/unit.h"

namespace abbe::paths {
namespace {

using recording::Recording;
using Rows = std::vector<std::size_t>;
using Column = std::optional<std::span<const double>>;

constexpr const char* kRadiusName = "ref_radius_mm";

std::string PositionName(int axis) { return fmt::format("{}_mm", "xyz"[axis]); }
std::string ReferenceName(int axis) { return fmt::format("ref_{}_mm", "xyz"[axis]); }

double Finite(const Recording& recording, std::span<const double> column, std::size_t row,
              const std::string& name) {
  if (std::isfinite(column[row])) return column[row];
  throw InputError(
      fmt::format("{}: row {}: {} is no number and has no flag; flag the row or leave "
                  "it out",
                  recording.name, row + 1, name));
}

// The column at the rows, times `si`; `fallback` where the recording lacks it.
Eigen::VectorXd Values(const Recording& recording, const Rows& rows, const std::string& name,
                       double si, double fallback) {
  Eigen::VectorXd values = Eigen::VectorXd::Constant(rows.size(), fallback);
  const Column column = recording.Find(name);
  if (!column) return values;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    values[i] = Finite(recording, *column, rows[i], name) * si;
  }
  return values;
}

double ProgrammedRadius(const Recording& recording) {
  const std::optional<double> radius = recording.HeaderNumber("radius_mm");
  if (radius && !(*radius > 0.0)) {
    throw InputError(fmt::format(
        "{}: radius_mm = {} in the header: write the programmed radius of the circle, above 0",
        recording.name, *radius));
  }
  return settings::kMillimetre * radius.value_or(0.0);
}

// The path without the measured positions: `measured` is `commanded`.
MeasuredPath Commanded(const Recording& recording, const Rows& rows) {
  MeasuredPath path;
  path.recording = recording.name;
  path.plane = recording.HeaderText("axis").value_or("");
  path.radius = ProgrammedRadius(recording);
  path.rows = rows;
  path.flagged = recording.rows() - rows.size();
  path.commanded.resize(3, rows.size());
  for (int axis = 0; axis < 3; ++axis) {
    path.commanded.row(axis) =
        Values(recording, rows, PositionName(axis), settings::kMillimetre, 0.0).transpose();
  }
  path.measured = path.commanded;
  path.time = recording.Find("time_s")
                  ? Values(recording, rows, "time_s", 1.0, 0.0)
                  : Eigen::VectorXd::LinSpaced(path.poses(), 0.0, path.poses());
  path.feed = Values(recording, rows, "feed_mm_min", settings::kMillimetrePerMinute, 0.0);
  path.pass = Values(recording, rows, "pass", 1.0, 1.0).cast<int>();
  path.direction =
      Values(recording, rows, "direction", 1.0, MeasuredPath::kDirectionNotStated).cast<int>();
  return path;
}

}  // namespace

MeasuredPath LinkagePath(const Recording& recording, const machine::Chain& chain, const Rows& rows,
                         const Eigen::Matrix3Xd& p_MT) {
  MeasuredPath path = Commanded(recording, rows);
  path.instrument = kByLinkage;
  path.seen = {true, true, true};
  path.measured = chain.ToolSenses().asDiagonal() * p_MT;
  return path;
}

MeasuredPath ReferencePath(const Recording& recording) {
  MeasuredPath path = Commanded(recording, recording::GoodRows(recording));
  path.instrument = "reference";
  for (int axis = 0; axis < 3; ++axis) {
    if (!recording.Find(ReferenceName(axis))) continue;
    path.seen[axis] = true;
    path.measured.row(axis) =
        Values(recording, path.rows, ReferenceName(axis), settings::kMillimetre, 0.0).transpose();
  }
  if (!HasReference(recording)) {
    throw InputError(fmt::format(
        "{}: has no column ref_x_mm, ref_y_mm or ref_z_mm: give a recording of a reference "
        "instrument",
        recording.name));
  }
  return path;
}

MeasuredPath BallbarPath(const Recording& recording) {
  MeasuredPath path = Commanded(recording, recording::GoodRows(recording));
  path.instrument = kByBallbar;
  if (const auto u = recording.HeaderNumber("u_length_um")) {
    if (!(*u > 0.0)) {
      throw InputError(fmt::format(
          "{}: u_length_um = {} in the header: write the standard uncertainty of the ballbar's "
          "length, above 0, or leave it out",
          recording.name, *u));
    }
    path.u_length = *u * settings::kMicrometre;
  }
  for (int axis = 0; axis < 3; ++axis) {
    path.seen[axis] = recording.Find(PositionName(axis)).has_value();
  }
  const Eigen::VectorXd radius =
      Values(recording, path.rows, kRadiusName, settings::kMillimetre, 0.0);
  for (Eigen::Index i = 0; i < path.poses(); ++i) {
    const double nominal = path.commanded.col(i).norm();
    if (!(nominal > 0.0) || !(radius[i] > 0.0)) {
      throw InputError(fmt::format(
          "{}: row {}: a radius of {} mm at {} mm from the centre; positions of a ballbar count "
          "from its centre",
          recording.name, path.rows[i] + 1, radius[i] / settings::kMillimetre,
          nominal / settings::kMillimetre));
    }
    path.measured.col(i) = radius[i] / nominal * path.commanded.col(i);
  }
  return path;
}

bool HasRadius(const Recording& recording) { return recording.Find(kRadiusName).has_value(); }

bool HasReference(const Recording& recording) {
  return recording.Find(ReferenceName(0)) || recording.Find(ReferenceName(1)) ||
         recording.Find(ReferenceName(2));
}

MeasuredPath Selection(const MeasuredPath& path, const std::vector<Eigen::Index>& poses) {
  MeasuredPath part = path;
  const Eigen::Index n = poses.size();
  part.rows.clear();
  part.commanded.resize(3, n);
  part.measured.resize(3, n);
  part.time.resize(n);
  part.feed.resize(n);
  part.pass.resize(n);
  part.direction.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index from = poses[i];
    part.rows.push_back(path.rows[from]);
    part.commanded.col(i) = path.commanded.col(from);
    part.measured.col(i) = path.measured.col(from);
    part.time[i] = path.time[from];
    part.feed[i] = path.feed[from];
    part.pass[i] = path.pass[from];
    part.direction[i] = path.direction[from];
  }
  return part;
}

}  // namespace abbe::paths
