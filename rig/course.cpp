#include "rig/course.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "failure/failure.h"

namespace abbe::rig {
namespace {

using Eigen::Vector3d;

constexpr int kPointsOfTurn = 20000;  // chord errors below 1e-8 of the radius
constexpr double kArrived = 1e-7;     // m

int SenseOf(const Vector3d& way) {
  for (const double each : way) {
    if (each != 0.0) return each > 0.0 ? 1 : -1;
  }
  return 1;
}

double LengthOf(const std::vector<Vector3d>& points) {
  double length = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
  return length;
}

}  // namespace

Course CircleCourse(const CircleProgram& program) {
  const int first = (program.normal - 'X' + 1) % 3, second = (first + 1) % 3;
  const auto at = [&](double turns) {
    Vector3d point = program.centre;
    point[first] += program.radius * std::cos(2.0 * std::numbers::pi * turns);
    point[second] += program.radius * std::sin(2.0 * std::numbers::pi * turns);
    return point;
  };
  Course course{at(-program.run_in), {}};
  for (const int sense : {1, -1}) {
    for (int pass = 1; pass <= program.passes; ++pass) {
      const double begin = -program.run_in, end = 1.0 + program.run_in;
      const int count = static_cast<int>(std::ceil((end - begin) * kPointsOfTurn));
      course.moves.push_back({{at(sense * begin)}, program.feed});
      Move turn{{}, program.feed, 0.0, pass, sense};
      turn.points.reserve(count);
      for (int i = 1; i <= count; ++i) {
        turn.points.push_back(at(sense * (begin + (end - begin) * i / count)));
      }
      const double length = LengthOf(turn.points) * count / (count - 1);
      turn.from = length * program.run_in / (end - begin);
      turn.to = length * (1.0 + program.run_in) / (end - begin);
      course.moves.push_back(std::move(turn));
    }
  }
  return course;
}

Course SquareCourse(const SquareProgram& program) {
  const int first = (program.normal - 'X' + 1) % 3, second = (first + 1) % 3;
  std::array<Vector3d, 4> corners;
  for (std::size_t i = 0; i < 4; ++i) {
    corners[i] = program.centre;
    corners[i][first] += (i == 1 || i == 2 ? 0.5 : -0.5) * program.side;
    corners[i][second] += (i >= 2 ? 0.5 : -0.5) * program.side;
  }
  Course course{corners[0], {}};
  for (const int sense : {1, -1}) {
    for (int pass = 1; pass <= program.passes; ++pass) {
      for (const std::size_t i : {1, 2, 3, 4}) {
        const Vector3d& corner = corners[(sense > 0 ? i : 4 - i) % 4];
        course.moves.push_back({{corner}, program.feed, 0.0, pass, sense, 0.0, program.side});
      }
    }
  }
  return course;
}

std::vector<Vector3d> SteppingPlaces(const Vector3d& start, double step, int count) {
  std::vector<Vector3d> places{start};
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 1; i <= 2 * count; ++i) {
      places.push_back(start + step * std::min(i, 2 * count - i) * Vector3d::Unit(axis));
    }
  }
  return places;
}

Course DwellCourse(const std::vector<Vector3d>& places, double feed, double dwell, int pass) {
  Course course{places.front(), {}};
  Vector3d before = places.front();
  for (const Vector3d& place : places) {
    course.moves.push_back({{place}, feed, dwell, pass, SenseOf(place - before)});
    before = place;
  }
  return course;
}

std::vector<Vector3d> GridPlaces(const Vector3d& centre, const Vector3d& size,
                                 const Eigen::Vector3i& counts) {
  std::vector<Vector3d> places;
  places.reserve(counts.prod());
  const auto share = [](int i, int count) {
    return count > 1 ? double(i) / (count - 1) - 0.5 : 0.0;
  };
  for (int k = 0; k < counts[2]; ++k) {
    for (int j = 0; j < counts[1]; ++j) {
      const int row = k % 2 == 0 ? j : counts[1] - 1 - j;
      for (int i = 0; i < counts[0]; ++i) {
        const int column = (k * counts[1] + j) % 2 == 0 ? i : counts[0] - 1 - i;
        places.push_back(
            centre + Vector3d(share(column, counts[0]), share(row, counts[1]), share(k, counts[2]))
                         .cwiseProduct(size));
      }
    }
  }
  return places;
}

Course LineCourse(const std::vector<Vector3d>& points, double feed, double dwell, int pass) {
  Course course{points.front(), {}};
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vector3d way = points[i] - points[i - 1];
    course.moves.push_back({{points[i]}, feed, dwell, pass, SenseOf(way), 0.0, way.norm()});
  }
  return course;
}

CourseRun::CourseRun(const Course& course, const Dynamics& dynamics, double step)
    : course_(course), dynamics_(dynamics), step_(step) {
  state_.command = state_.position = course.start;
  Begin();
}

void CourseRun::Begin() {
  if (move_ >= course_.moves.size()) return;
  const Move& move = course_.moves[move_];
  way_ = {state_.command};
  way_.insert(way_.end(), move.points.begin(), move.points.end());
  lengths_.assign(1, 0.0);
  for (std::size_t i = 1; i < way_.size(); ++i) {
    lengths_.push_back(lengths_.back() + (way_[i] - way_[i - 1]).norm());
  }
  segment_ = 1;
  since_ = 0.0;
  const double length = lengths_.back();
  peak_ = std::min(move.feed, std::sqrt(length * dynamics_.acceleration));
  ramp_ = peak_ / dynamics_.acceleration;
  cruise_ = peak_ > 0.0 ? std::max(0.0, length / peak_ - ramp_) : 0.0;
}

double CourseRun::DistanceAt(double since) const {
  const double a = dynamics_.acceleration;
  if (since < ramp_) return 0.5 * a * since * since;
  if (since < ramp_ + cruise_) return peak_ * (since - 0.5 * ramp_);
  const double left = std::max(0.0, 2.0 * ramp_ + cruise_ - since);
  return lengths_.back() - 0.5 * a * left * left;
}

Vector3d CourseRun::PointAt(double distance) {
  while (segment_ + 1 < way_.size() && lengths_[segment_] < distance) ++segment_;
  const double piece = lengths_[segment_] - lengths_[segment_ - 1];
  const double share =
      piece > 0.0 ? std::clamp((distance - lengths_[segment_ - 1]) / piece, 0.0, 1.0) : 1.0;
  return way_[segment_ - 1] + share * (way_[segment_] - way_[segment_ - 1]);
}

void RefuseTooLong(double duration, double rate) {
  constexpr double kMostRows = 2e7, kLongest = 86400.0;
  if (duration <= kLongest && duration * rate <= kMostRows) return;
  throw InputError(fmt::format(
      "the recording would take {:.3g} hours and have {:.3g} rows, at most 24 and {:.3g} "
      "are made; take a higher feed, a lower rate, or fewer points",
      duration / 3600.0, duration * rate, kMostRows));
}

double CourseRun::DurationOf(const Course& course, const Dynamics& dynamics, double step) {
  CourseRun run(course, dynamics, step);
  double duration = 0.0;
  for (; run.move_ < course.moves.size(); ++run.move_) {
    if (run.move_ > 0) run.state_.command = course.moves[run.move_ - 1].points.back();
    run.Begin();
    duration += 2.0 * run.ramp_ + run.cruise_ + course.moves[run.move_].dwell + 8.0 * dynamics.lag +
                4.0 * step;
  }
  return duration;
}

bool CourseRun::Next() {
  // A move ends when its dwell, counted from the arrival of the axes, is over.
  while (move_ < course_.moves.size() && state_.standing &&
         since_ > 2.0 * ramp_ + cruise_ + course_.moves[move_].dwell + 8.0 * dynamics_.lag) {
    ++move_;
    Begin();
    state_.standing = false;
  }
  if (move_ >= course_.moves.size()) return false;
  const Move& move = course_.moves[move_];
  since_ += step_;
  state_.time += step_;
  const double distance = DistanceAt(since_);
  const Vector3d command = PointAt(distance);
  // x' = (c - x) / lag with c straight from one step to the next: x trails by lag * velocity.
  const Vector3d before = state_.position;
  const Vector3d trailing = dynamics_.lag * (command - state_.command) / step_;
  const double kept = std::exp(-step_ / dynamics_.lag);
  state_.position = command - trailing + kept * (before - state_.command + trailing);
  state_.velocity = (state_.position - before) / step_;
  state_.command = command;
  state_.standing = since_ > 2.0 * ramp_ + cruise_ && (state_.position - command).norm() < kArrived;
  state_.pass = move.pass;
  state_.direction = move.direction;
  state_.feed = move.feed;
  const bool on_the_way = distance >= move.from && distance <= move.to;
  state_.counts = move.pass > 0 && (on_the_way || (move.dwell > 0.0 && state_.standing));
  return true;
}

}  // namespace abbe::rig
