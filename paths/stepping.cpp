#include "paths/stepping.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "failure/failure.h"
#include "paths/stays.h"
#include "standards/student_coverage.h"

namespace abbe::paths {
namespace {

constexpr double kSamePlace = 20e-6;  // m: largest distance between visits to one stop

// The axis along which the machine went from one stay to the next, if it was one alone.
std::optional<int> AxisOfMove(const Stay& from, const Stay& to) {
  const Eigen::Vector3d move = (to.commanded - from.commanded).cwiseAbs();
  int moved = 0, axis = 0;
  for (int i = 0; i < 3; ++i) {
    if (move[i] < kSamePlace) continue;
    ++moved;
    axis = i;
  }
  return moved == 1 ? std::optional(axis) : std::nullopt;
}

struct Visits {
  Eigen::Vector3d commanded = Eigen::Vector3d::Zero(), measured = Eigen::Vector3d::Zero();
  double squares = 0.0;   // of all measured coordinates
  double variance = 0.0;  // of one coordinate within a visit, summed over them
  int count = 0;
};

// The variance of one coordinate of a visit, as the visits to the same stops differ, and as wide as
// Student's t for so few of them; 0 where none is visited twice.
double BetweenVisits(const std::map<long long, Visits>& places) {
  double squares = 0.0, freedom = 0.0;
  for (const auto& [place, visits] : places) {
    squares += visits.squares - visits.measured.squaredNorm() / visits.count;
    freedom += 3.0 * (visits.count - 1);
  }
  if (freedom == 0.0) return 0.0;
  const double t = standards::StudentWidening(freedom);
  return std::max(squares, 0.0) / freedom * t * t;
}

SteppingLine LineOf(int axis, const std::vector<Stay>& stays) {
  std::map<long long, Visits> places;
  for (const Stay& stay : stays) {
    const double along = stay.commanded[axis] - stays.front().commanded[axis];
    Visits& visits = places[std::llround(along / kSamePlace)];
    visits.commanded += stay.commanded;
    const Eigen::Vector3d measured = stay.measured - stays.front().measured;
    visits.measured += measured;
    visits.squares += measured.squaredNorm();
    visits.variance += stay.scatter.squaredNorm() / 3.0 / stay.rows;
    ++visits.count;
  }
  const Visits& start = places.at(0);
  const double between = BetweenVisits(places);
  const auto variance_of = [between](const Visits& visits) {
    return std::max(visits.variance / visits.count, between) / visits.count;
  };
  SteppingLine line{"XYZ" [axis], {}};
  for (const auto& [place, visits] : places) {
    const Eigen::Vector3d commanded =
        visits.commanded / visits.count - start.commanded / start.count;
    const Eigen::Vector3d measured = visits.measured / visits.count - start.measured / start.count;
    const double variance = variance_of(visits) + (place == 0 ? 0.0 : variance_of(start));
    const Eigen::Vector3d deviation = measured - commanded;
    line.stops.push_back({commanded[axis], deviation, std::sqrt(variance), visits.count});
    line.largest_along = std::max(line.largest_along, std::abs(deviation[axis]));
    line.largest = std::max(line.largest, deviation.norm());
  }
  return line;
}

}  // namespace

std::vector<SteppingLine> EvaluateStepping(const MeasuredPath& path) {
  const std::vector<Stay> stays = Stays(path);
  std::vector<SteppingLine> lines;
  for (std::size_t begin = 0; begin + 1 < stays.size();) {
    const std::optional<int> axis = AxisOfMove(stays[begin], stays[begin + 1]);
    if (!axis) {
      ++begin;
      continue;
    }
    std::size_t end = begin + 2;
    while (end < stays.size() && AxisOfMove(stays[end - 1], stays[end]) == axis) ++end;
    lines.push_back(LineOf(*axis, {stays.begin() + begin, stays.begin() + end}));
    begin = end - 1;
  }
  if (lines.empty()) {
    throw InputError(fmt::format(
        "{}: {} stops, no two of which differ in one axis alone: a stepping test stops every few "
        "millimetres along X, Y or Z, for {} rows at least",
        path.recording, stays.size(), kLeastRows));
  }
  return lines;
}

}  // namespace abbe::paths
