// The motion of the machine along programmed paths in space: a pure function of the program,
// computed step by step in time.
//
//   const Course course = CircleCourse({.radius = 0.01, .feed = 1e-3});
//   CourseRun run(course, {.acceleration = 0.2, .lag = 0.015}, 1e-3);
//   while (run.Next()) states.push_back(run.state());
//
// Each move runs along its points with a trapezoid of speed (constant acceleration to the feed,
// constant braking to a standstill at its end, no braking at inner points), then stands for its
// dwell. Each axis follows its command like a first-order lag, solved exactly
// for a command that runs straight within one step. m, s.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace abbe::rig {

struct Move {
  std::vector<Eigen::Vector3d> points;  // after the end of the last move; at least one
  double feed;                          // m/s
  double dwell = 0.0;                   // s, at the end
  int pass = 0;                         // 0: not to be recorded
  int direction = 0;
  double from = 0.0, to = -1.0;  // m along the move: recorded while there; none if to < from
};

struct Course {
  Eigen::Vector3d start;
  std::vector<Move> moves;
};

struct CircleProgram {
  char normal = 'Z';  // of the plane, right-handed
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius, feed;
  int passes = 1;        // of each sense
  double run_in = 0.25;  // turns before and after the recorded full turn
};
// Counter-clockwise (direction +1) and clockwise (-1), from the first axis of the plane on.
Course CircleCourse(const CircleProgram& program);

// Stands for `dwell` at each place, in the order given; recorded while standing. Direction: the
// sign of the first coordinate that the move there changed.
Course DwellCourse(const std::vector<Eigen::Vector3d>& places, double feed, double dwell, int pass);

// A square of two axes, counter-clockwise (+1) and clockwise (-1) from its lower left corner.
struct SquareProgram {
  char normal = 'Z';
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double side, feed;
  int passes = 1;  // of each sense
};
Course SquareCourse(const SquareProgram& program);

// From the start `count` steps along x and back, then along y, then along z.
std::vector<Eigen::Vector3d> SteppingPlaces(const Eigen::Vector3d& start, double step, int count);

// The points of a grid of counts[i] points over a box about `centre`, line by line, back and forth.
std::vector<Eigen::Vector3d> GridPlaces(const Eigen::Vector3d& centre, const Eigen::Vector3d& size,
                                        const Eigen::Vector3i& counts);

// Along straight lines through the points, recorded on the way; a standstill at each.
Course LineCourse(const std::vector<Eigen::Vector3d>& points, double feed, double dwell, int pass);

struct CourseState {
  double time = 0.0;
  Eigen::Vector3d command = Eigen::Vector3d::Zero();   // where the axes are sent
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // where they are
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // of the axes
  int pass = 0, direction = 0;
  double feed = 0.0;
  bool standing = false;  // the command has arrived and the axes are within 0.1 um of it
  bool counts = false;    // to be recorded
};

// InputError when a recording of so many seconds would have more than 20 million rows, or take more
// than a day.
void RefuseTooLong(double duration, double rate);

class CourseRun {
 public:
  struct Dynamics {
    double acceleration, lag;
  };
  CourseRun(const Course& course, const Dynamics& dynamics, double step);

  // An upper bound of the whole duration, s; above it by a few steps a move.
  static double DurationOf(const Course& course, const Dynamics& dynamics, double step);

  // One step on; false when the course has ended.
  bool Next();
  const CourseState& state() const { return state_; }

 private:
  void Begin();
  double DistanceAt(double since) const;
  Eigen::Vector3d PointAt(double distance);

  const Course& course_;
  Dynamics dynamics_;
  double step_;
  CourseState state_;
  std::size_t move_ = 0, segment_ = 0;
  double since_ = 0.0;                             // s, of the move
  std::vector<Eigen::Vector3d> way_;               // with its first point
  std::vector<double> lengths_;                    // along it
  double ramp_ = 0.0, cruise_ = 0.0, peak_ = 0.0;  // s, s, m/s
};

}  // namespace abbe::rig
