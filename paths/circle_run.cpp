#include "paths/circle_run.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "failure/failure.h"
#include "failure/located.h"
#include "paths/circle_middle.h"
#include "standards/circle.h"
#include "standards/closed_profile_filter.h"

namespace abbe::paths {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
// Part of the radius; commanded rows further off the circle are run-in and run-out.
constexpr double kOffCircle = 0.01;
// Part of the radius; a commanded path that leaves its plane by more is inclined.
constexpr double kOffPlane = 1e-3;
// rad; a block that turns by less is not part of a circle.
constexpr double kLeastTurn = 0.1;
// Two runs are one when radius and centre agree to this, m, and the feed to this part.
constexpr double kSameCircle = 10e-6;
constexpr double kSameFeed = 0.01;
// Parts of a turn: below kWhole it is an arc, below kLeastCovered too short to evaluate.
constexpr double kWhole = 0.95;
constexpr double kLeastCovered = 0.25;
// Between points: so many times as wide as usual is a gap, above the least and up to the most, rad.
constexpr double kWideGap = 2.5;
constexpr double kLeastGap = 0.1;
constexpr double kMostGap = 0.6;

CirclePlane NamedPlane(const std::string& name, const std::string& recording) {
  const auto axis = [&](std::size_t i) {
    const std::size_t found =
        i < name.size() ? std::string("XYZ").find(name[i]) : std::string::npos;
    if (name.size() == 2 && found != std::string::npos && name[0] != name[1]) return found;
    throw InputError(fmt::format(
        "{}: plane \"{}\": name two axes, the first turning towards the second: XY, YZ or ZX",
        recording, name));
  };
  CirclePlane plane{name, Eigen::Vector3d::Unit(axis(0)), Eigen::Vector3d::Unit(axis(1)), {}};
  plane.third = plane.first.cross(plane.second);
  return plane;
}

// The plane in which the commanded path lies.
CirclePlane CommandedPlane(const MeasuredPath& path) {
  const Eigen::Matrix3Xd centred =
      path.commanded.colwise() - Eigen::Vector3d(path.commanded.rowwise().mean());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(centred * centred.transpose());
  const Eigen::Vector3d normal = axes.eigenvectors().col(0);
  Eigen::Index along = 0;
  if (normal.cwiseAbs().maxCoeff(&along) > 1.0 - kOffPlane * kOffPlane) {
    static const char* const kNames[] = {"YZ", "ZX", "XY"};
    return NamedPlane(kNames[along], path.recording);
  }
  CirclePlane plane{"inclined", {}, {}, normal[along] < 0 ? Eigen::Vector3d(-normal) : normal};
  Eigen::Index across = 0;  // the axis nearest to the plane gives its first direction
  normal.cwiseAbs().minCoeff(&across);
  plane.first = (Eigen::Vector3d::Unit(across) - normal * normal[across]).normalized();
  plane.second = plane.third.cross(plane.first);
  return plane;
}

void RefuseUnseen(const MeasuredPath& path, const CirclePlane& plane) {
  for (int axis = 0; axis < 3; ++axis) {
    const bool needed = plane.first[axis] != 0.0 || plane.second[axis] != 0.0;
    if (needed && !path.seen[axis]) {
      throw InputError(fmt::format(
          "{}: the {} circle needs ref_{}_mm, which the recording lacks; name the plane that was "
          "measured with --plane",
          path.recording, plane.name, "xyz"[axis]));
    }
  }
}

struct InPlane {
  std::vector<double> first, second;
};

InPlane Project(const Eigen::Matrix3Xd& p, const CirclePlane& plane) {
  const Eigen::VectorXd a = p.transpose() * plane.first, b = p.transpose() * plane.second;
  return {{a.begin(), a.end()}, {b.begin(), b.end()}};
}

// The circle of least squares. InputError with the recording where there is none.
standards::Circle CircleOf(const InPlane& path, const std::string& recording) {
  return Located(recording, [&] {
    return standards::ReferenceCircle(standards::CircleKind::kLeastSquares, path.first,
                                      path.second);
  });
}

// The commanded circle, and the poses on it.
struct Nominal {
  standards::Circle circle;
  std::vector<Eigen::Index> on;
};

Nominal CommandedCircle(const MeasuredPath& path, const CirclePlane& plane) {
  const InPlane all = Project(path.commanded, plane);
  Nominal nominal;
  try {
    nominal.circle =
        standards::ReferenceCircle(standards::CircleKind::kLeastSquares, all.first, all.second);
  } catch (const Failure& failure) {
    throw InputError(fmt::format("{}: the commanded path in {} is no circle: {}", path.recording,
                                 plane.name, failure.what()));
  }
  // Run-in and run-out bias the first circle; each round leaves out the poses off the last one.
  for (int round = 0; round < 20; ++round) {
    const std::vector<double> off =
        standards::RadialDeviations(nominal.circle, all.first, all.second);
    std::vector<double> sizes(off.size());
    std::transform(off.begin(), off.end(), sizes.begin(), [](double d) { return std::abs(d); });
    std::vector<double> sorted = sizes;
    std::nth_element(sorted.begin(), sorted.begin() + (sorted.size() / 2), sorted.end());
    const double limit =
        std::max(kOffCircle * nominal.circle.radius, 3.0 * sorted[sorted.size() / 2]);
    InPlane kept;
    nominal.on.clear();
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      if (sizes[i] > limit || path.direction[i] == 0) continue;
      nominal.on.push_back(i);
      kept.first.push_back(all.first[i]);
      kept.second.push_back(all.second[i]);
    }
    const double before = nominal.circle.radius;
    nominal.circle = CircleOf(kept, path.recording);
    if (limit <= kOffCircle * nominal.circle.radius &&
        std::abs(nominal.circle.radius - before) < 1e-9) {
      return nominal;
    }
  }
  throw InputError(
      fmt::format("{}: the commanded path in {} is no circle: half of it is more than {:.3g} of "
                  "the radius off; abbe path takes other paths",
                  path.recording, plane.name, kOffCircle));
}

double Wrapped(double angle) { return angle - kTurn * std::round(angle / kTurn); }

// The sense of the commanded path at each pose: +1 or -1, 0 for blocks that do not turn. A block
// has one pass, direction and feed.
std::vector<int> Senses(const MeasuredPath& on, const CirclePlane& plane,
                        const standards::Circle& circle) {
  const InPlane p = Project(on.commanded, plane);
  const std::size_t n = on.poses();
  std::vector<int> senses(n);
  const auto angle = [&](std::size_t i) {
    return std::atan2(p.second[i] - circle.y, p.first[i] - circle.x);
  };
  for (std::size_t begin = 0, end = 0; begin < n; begin = end) {
    const auto same = [&](std::size_t i) {
      const Eigen::Index a = begin, b = i;
      return on.pass[a] == on.pass[b] && on.direction[a] == on.direction[b] &&
             on.feed[a] == on.feed[b];
    };
    double turned = 0.0;
    for (end = begin + 1; end < n && same(end); ++end) {
      turned += Wrapped(angle(end) - angle(end - 1));
    }
    const int sense = turned > kLeastTurn ? 1 : turned < -kLeastTurn ? -1 : 0;
    std::fill(senses.begin() + begin, senses.begin() + end, sense);
  }
  return senses;
}

bool SameRun(const CircleRun& a, const CircleRun& b) {
  return a.instrument == b.instrument && a.plane.name == b.plane.name &&
         a.is_programmed == b.is_programmed && std::abs(a.radius - b.radius) < kSameCircle &&
         (a.centre - b.centre).norm() < kSameCircle &&
         (a.plane.third - b.plane.third).norm() < kOffPlane &&
         std::abs(a.feed - b.feed) <= kSameFeed * std::max(a.feed, b.feed);
}

// The programmed radius, m; 0 where neither the options nor the header state it.
double ProgrammedRadius(const MeasuredPath& path, const CircleOptions& options, double commanded) {
  const double radius = options.radius > 0.0 ? options.radius : path.radius;
  if (radius > 0.0 && std::abs(radius - commanded) > kLikeCommanded * radius) {
    throw InputError(fmt::format(
        "{}: {} states a radius of {:.6g} mm, but x_mm, y_mm, z_mm go round one of {:.6g} mm; "
        "correct it",
        path.recording, options.radius > 0.0 ? "--radius" : "radius_mm of the header", 1e3 * radius,
        1e3 * commanded));
  }
  return radius;
}

// The runs of one path without angles, which need the whole run.
std::vector<CircleRun> RunsOf(const MeasuredPath& path, const CircleOptions& options) {
  const std::string named = !options.plane.empty()   ? options.plane
                            : path.plane.size() == 2 ? path.plane
                                                     : std::string();
  const CirclePlane plane =
      named.empty() ? CommandedPlane(path) : NamedPlane(named, path.recording);
  RefuseUnseen(path, plane);
  const Nominal nominal = CommandedCircle(path, plane);
  const MeasuredPath on = Selection(path, nominal.on);
  const std::vector<int> senses = Senses(on, plane, nominal.circle);
  CircleRun proto;
  proto.recordings = {path.recording};
  proto.instrument = path.instrument;
  proto.plane = plane;
  const double programmed = ProgrammedRadius(path, options, nominal.circle.radius);
  proto.is_programmed = programmed > 0.0;
  proto.radius = proto.is_programmed ? programmed : nominal.circle.radius;
  proto.centre = plane.first * nominal.circle.x + plane.second * nominal.circle.y +
                 plane.third * plane.third.dot(Eigen::Vector3d(on.commanded.rowwise().mean()));
  proto.u_length = path.u_length;
  proto.third_seen = path.seen[0] && path.seen[1] && path.seen[2];
  std::vector<CircleRun> runs;
  std::size_t used = 0;
  for (Eigen::Index i = 0; i < on.poses(); ++i) {
    const int sense = senses[i];
    if (sense == 0) continue;
    const Eigen::Vector3d p = on.measured.col(i) - proto.centre;
    proto.feed = on.feed[i];
    auto run =
        std::ranges::find_if(runs, [&](const CircleRun& one) { return SameRun(one, proto); });
    if (run == runs.end()) run = runs.insert(runs.end(), proto);
    run->points.push_back(
        {p.dot(plane.first), p.dot(plane.second), p.dot(plane.third), 0.0, sense, on.pass[i]});
    ++used;
  }
  if (runs.empty()) {
    throw InputError(
        fmt::format("{}: no part of the commanded path goes round the circle", path.recording));
  }
  runs.front().left_out = path.flagged + path.poses() - used;
  return runs;
}

void Join(CircleRun& into, const CircleRun& other) {
  into.recordings.insert(into.recordings.end(), other.recordings.begin(), other.recordings.end());
  into.points.insert(into.points.end(), other.points.begin(), other.points.end());
  into.left_out += other.left_out;
}

InPlane Coordinates(const CircleRun& run, int sense) {
  InPlane path;
  for (const CirclePoint& point : run.points) {
    if (sense != 0 && point.sense != sense) continue;
    path.first.push_back(point.first);
    path.second.push_back(point.second);
  }
  return path;
}

void RefuseBit(const CircleRun& run) {
  for (const int sense : {1, -1}) {
    const double covered = run.Covered(sense);
    if (!run.Has(sense) || covered >= kLeastCovered * kTurn) continue;
    throw InputError(fmt::format(
        "{}: {} points {} are on {:.0f} of 360 degrees; measure a quarter turn at least, better "
        "whole turns, with a point every few degrees",
        run.recordings.front(), std::ranges::count(run.points, sense, &CirclePoint::sense),
        sense > 0 ? "counter-clockwise" : "clockwise", covered * 360.0 / kTurn));
  }
}

}  // namespace

bool CircleRun::Has(int sense) const {
  return std::ranges::count(points, sense, &CirclePoint::sense) > 0;
}

bool CircleRun::Partial() const {
  const auto part = [this](int sense) { return Has(sense) && Covered(sense) < kWhole * kTurn; };
  return part(1) || part(-1);
}

double CircleRun::Covered(int sense) const {
  std::vector<double> angles;
  for (const CirclePoint& point : points) {
    if (point.sense == sense)
      angles.push_back(point.angle - kTurn * std::floor(point.angle / kTurn));
  }
  if (angles.size() < 2) return 0.0;
  std::ranges::sort(angles);
  std::vector<double> gaps{angles.front() + kTurn - angles.back()};
  for (std::size_t i = 1; i < angles.size(); ++i) gaps.push_back(angles[i] - angles[i - 1]);
  std::ranges::sort(gaps);
  // Points of several passes stand close together: the usual gap is one of the wider ones.
  const double usual = gaps[gaps.size() - 1 - gaps.size() / 4];
  if (usual > kMostGap) return 0.0;
  const double wide = std::clamp(kWideGap * usual, kLeastGap, kMostGap);
  double covered = kTurn;
  for (const double gap : gaps) {
    if (gap > wide) covered -= gap - usual;  // the points beside it stand for half of one each
  }
  return covered;
}

std::vector<CircleRun> CircleRuns(const std::vector<MeasuredPath>& paths,
                                  const CircleOptions& options) {
  std::vector<CircleRun> runs;
  for (const MeasuredPath& path : paths) {
    for (const CircleRun& run : RunsOf(path, options)) {
      const auto same =
          std::ranges::find_if(runs, [&](const CircleRun& one) { return SameRun(one, run); });
      same == runs.end() ? runs.push_back(run) : Join(*same, run);
    }
  }
  for (CircleRun& run : runs) {
    FindMiddle(run);
    RefuseBit(run);
  }
  return runs;
}

CircleRun Filtered(const CircleRun& run, double cutoff) {
  if (cutoff <= 0.0) return run;
  CircleRun filtered = run;
  for (const int sense : {1, -1}) {
    const InPlane path = Coordinates(run, sense);
    if (path.first.empty()) continue;
    const standards::Circle circle = CircleOf(path, run.recordings.front());
    std::vector<double> angles;
    for (std::size_t i = 0; i < path.first.size(); ++i) {
      angles.push_back(std::atan2(path.second[i] - circle.y, path.first[i] - circle.x));
    }
    const std::vector<double> smooth = standards::FilterClosedProfile(
        angles, standards::RadialDeviations(circle, path.first, path.second), cutoff);
    std::size_t next = 0;
    for (CirclePoint& point : filtered.points) {
      if (point.sense != sense) continue;
      const double r = circle.radius + smooth[next];
      point.first = circle.x + r * std::cos(angles[next]);
      point.second = circle.y + r * std::sin(angles[next]);
      ++next;
    }
  }
  return filtered;
}

CircleFigures EvaluateCircle(const CircleRun& run, const FigureOptions& options) {
  const CircleRun smooth = Filtered(run, options.cutoff);
  const InPlane cw = Coordinates(smooth, -1), ccw = Coordinates(smooth, 1);
  CircleFigures figures;
  figures.is_programmed = run.is_programmed;
  try {
    figures.iso = standards::EvaluateCircularity(
        {run.radius, {cw.first, cw.second}, {ccw.first, ccw.second}});
  } catch (const Failure& failure) {
    throw InputError(fmt::format("{}: {}", run.recordings.front(), failure.what()));
  }
  if (run.Partial()) figures.iso.D.reset();
  for (const int sense : {-1, 1}) {
    const InPlane path = Coordinates(run, sense);
    if (path.first.empty() || run.Partial()) continue;
    const auto& circle = (sense < 0 ? figures.iso.cw : figures.iso.ccw)->least_squares;
    std::vector<double> angles;
    for (std::size_t i = 0; i < path.first.size(); ++i) {
      angles.push_back(std::atan2(path.second[i] - circle.y, path.first[i] - circle.x));
    }
    const int shown = (static_cast<int>(angles.size()) - 1) / 2;
    (sense < 0 ? figures.cw : figures.ccw) = standards::FitHarmonics(
        angles, standards::RadialDeviations(circle, path.first, path.second),
        std::min(options.harmonics, shown));
  }
  if (run.third_seen) {
    const auto [low, high] = std::ranges::minmax_element(run.points, {}, &CirclePoint::third);
    figures.out_of_plane = high->third - low->third;
  }
  return figures;
}

}  // namespace abbe::paths
