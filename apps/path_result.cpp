#include "apps/path_result.h"

#include <fmt/format.h>

#include <cmath>

#include "settings/unit.h"
#include "standards/coverage.h"
#include "standards/student_coverage.h"

namespace abbe::apps {
namespace {

using nlohmann::ordered_json;
using settings::Mm;
using settings::Um;

constexpr Eigen::Index kShownPoses = 1000;  // of a path in the result: sufficient for a figure

double Urad(double angle) { return angle / settings::kMicroradian; }

ordered_json Vector(const Eigen::Vector3d& v, double (*unit)(double)) {
  return {unit(v.x()), unit(v.y()), unit(v.z())};
}

std::string U95OfCap(const paths::CapDisplacement& one) {
  return one.dof > 0.0 ? fmt::format("{:.3f}", Um(standards::StudentCoverage(one.dof) * one.u))
                       : "-";
}

// At most kShownPoses columns, evenly chosen, in SI.
ordered_json Rows(const Eigen::Matrix3Xd& p, int row) {
  ordered_json list = ordered_json::array();
  const Eigen::Index step = 1 + (p.cols() - 1) / kShownPoses;
  for (Eigen::Index i = 0; i < p.cols(); i += step) list.push_back(p(row, i));
  return list;
}

}  // namespace

TestResult SteppingResult(const std::vector<paths::SteppingLine>& lines) {
  TestResult result;
  for (const paths::SteppingLine& line : lines) {
    result.table += fmt::format("  {} axis\n  {:>12}{:>12}{:>12}{:>12}{:>10}{:>8}\n", line.axis,
                                "stop, mm", "X, um", "Y, um", "Z, um", "U95, um", "visits");
    ordered_json stops = ordered_json::array();
    for (const paths::SteppingStop& stop : line.stops) {
      result.table +=
          fmt::format("  {:>12.4f}{:>12.2f}{:>12.2f}{:>12.2f}{:>10.2f}{:>8}\n", Mm(stop.commanded),
                      Um(stop.deviation.x()), Um(stop.deviation.y()), Um(stop.deviation.z()),
                      Um(standards::kCoverage * stop.u), stop.visits);
      stops.push_back({{"commanded_mm", Mm(stop.commanded)},
                       {"deviation_um", Vector(stop.deviation, Um)},
                       {"u_um", Um(stop.u)},
                       {"visits", stop.visits}});
    }
    result.table += fmt::format("  largest along the axis {:.2f} um, in space {:.2f} um\n",
                                Um(line.largest_along), Um(line.largest));
    result.data["lines"].push_back({{"axis", std::string(1, line.axis)},
                                    {"largest_along_um", Um(line.largest_along)},
                                    {"largest_um", Um(line.largest)},
                                    {"stops", std::move(stops)}});
  }
  return result;
}

TestResult SquareResult(const paths::SquareFigures& figures) {
  TestResult result;
  result.data["plane"] = figures.plane;
  result.table = fmt::format("  {:<10}{:>14}{:>14}{:>16}{:>16}\n", "side along", "nominal, mm",
                             "longer by, um", "straightness LS", "minimum zone");
  for (const paths::SquareSide& side : figures.sides) {
    result.table += fmt::format("  {:<10}{:>14.4f}{:>14.2f}{:>16.2f}{:>16.2f}\n", side.axis,
                                Mm(side.nominal), Um(side.length - side.nominal),
                                Um(side.least_squares.error), Um(side.minimum_zone.error));
    result.data["sides"].push_back({{"axis", std::string(1, side.axis)},
                                    {"nominal_mm", Mm(side.nominal)},
                                    {"length_error_um", Um(side.length - side.nominal)},
                                    {"straightness_ls_um", Um(side.least_squares.error)},
                                    {"straightness_mz_um", Um(side.minimum_zone.error)},
                                    {"along", side.along},
                                    {"across", side.across}});
  }
  result.table += "  corners, urad from 90 degrees:";
  for (const double corner : figures.corners) {
    result.table += fmt::format(" {:.1f}", Urad(corner));
    result.data["corners_urad"].push_back(Urad(corner));
  }
  result.table += "\n";
  return result;
}

TestResult DeviationResult(const paths::PathDeviation& raw, const paths::PathDeviation& aligned) {
  TestResult result;
  result.table =
      fmt::format("  {:<26}{:>14}{:>12}\n  {:<26}{:>14.2f}{:>12.2f}\n  {:<26}{:>14.2f}{:>12.2f}\n",
                  "distance to the path, um", "largest", "rms", "as measured", Um(raw.largest),
                  Um(raw.rms), "aligned as a rigid body", Um(aligned.largest), Um(aligned.rms));
  result.data = {{"length_mm", Mm(raw.length)},
                 {"largest_um", Um(raw.largest)},
                 {"rms_um", Um(raw.rms)},
                 {"aligned_largest_um", Um(aligned.largest)},
                 {"aligned_rms_um", Um(aligned.rms)}};
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name(1, "xyz"[axis]);
    result.data["path"][name] = Rows(aligned.measured, axis);
    result.data["path"]["d" + name] = Rows(aligned.deviation, axis);
  }
  return result;
}

TestResult CapResult(const std::vector<paths::CapDisplacement>& displacements) {
  TestResult result;
  result.table = fmt::format("  {:>10}{:>14}{:>26}{:>10}{:>13}{:>9}\n", "force, N", "feed, mm/min",
                             "against the motion, um", "U95, um", "scatter, um", "rows");
  for (const paths::CapDisplacement& one : displacements) {
    result.table += fmt::format("  {:>10}{:>14.0f}{:>26.3f}{:>10}{:>13.3f}{:>9}\n",
                                std::isfinite(one.force) ? fmt::format("{:.2f}", one.force) : "-",
                                Mm(one.feed) * 60.0, Um(one.displacement), U95OfCap(one),
                                Um(one.scatter), one.rows);
    ordered_json entry{{"feed_mm_min", Mm(one.feed) * 60.0},
                       {"displacement_um", Um(one.displacement)},
                       {"scatter_um", Um(one.scatter)},
                       {"rows", one.rows}};
    if (one.dof > 0.0) {
      entry["u_um"] = Um(one.u);
      entry["coverage"] = standards::StudentCoverage(one.dof);
    }
    if (std::isfinite(one.force)) entry["force_n"] = one.force;
    result.data["displacements"].push_back(std::move(entry));
  }
  return result;
}

TestResult ArticulationResult(const standards::Articulation& figures) {
  TestResult result;
  result.table = fmt::format(
      "  {} poses of the ball in one seat\n"
      "  location (ISO 10360-12), diameter of the smallest sphere {:>10.2f} um\n"
      "  largest distance to the mean (ASME B89.4.22)             {:>10.2f} um\n"
      "  range of the distances                                   {:>10.2f} um\n"
      "  two standard deviations (ASME B89.4.22)                  {:>10.2f} um\n",
      figures.distances.size(), Um(figures.location), Um(figures.largest), Um(figures.range),
      Um(figures.two_sigma));
  result.data = {{"poses", figures.distances.size()},     {"location_um", Um(figures.location)},
                 {"largest_um", Um(figures.largest)},     {"range_um", Um(figures.range)},
                 {"two_sigma_um", Um(figures.two_sigma)}, {"mean_mm", Vector(figures.mean, Mm)}};
  for (const double distance : figures.distances) {
    result.data["distances_um"].push_back(Um(distance));
  }
  return result;
}

}  // namespace abbe::apps
