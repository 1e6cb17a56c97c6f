#include "compensation/nc_cycles.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "compensation/nc_block.h"
#include "compensation/nc_path.h"

namespace abbe::compensation {
namespace {

using Eigen::Vector3d;

// Collects the steps of a cycle; positions by their coordinates in the plane and along its normal.
class CycleMoves {
 public:
  CycleMoves(const NcCycle& cycle, const Vector3d& from, std::size_t line_number)
      : cycle_(cycle), axes_(AxesOfPlane(cycle.plane)), line_number_(line_number), at_(from) {}

  double Normal() const { return at_[axes_[2]]; }
  void Over(double first, double second) {
    at_[axes_[0]] = first;
    at_[axes_[1]] = second;
    Add(NcStep::kRapid);
  }
  void To(NcStep step, double normal) {
    at_[axes_[2]] = normal;
    Add(step);
  }
  void Add(NcStep step) {
    if (static_cast<double>(steps_.size()) >= kMostLines) {
      RefuseLine(line_number_, fmt::format("the cycle would become more than {:.0e} lines; check Q "
                                           "and L",
                                           kMostLines));
    }
    steps_.push_back({step, at_});
  }

  // The hole itself, from R.
  void Hole(double r, double bottom, double clear) {
    const bool pecks = cycle_.code == 73 || cycle_.code == 83;
    for (double depth = r - cycle_.peck; pecks && depth > bottom; depth -= cycle_.peck) {
      To(NcStep::kFeed, depth);
      if (cycle_.code == 83) To(NcStep::kRapid, clear);
      To(NcStep::kRapid, depth + cycle_.gap);
    }
    To(NcStep::kFeed, bottom);
    const bool dwells = cycle_.code == 82 || cycle_.code == 86 || cycle_.code == 89;
    if (dwells) Add(NcStep::kDwell);
    if (cycle_.code == 86) Add(NcStep::kSpindleStop);
    const bool feeds_out = cycle_.code == 85 || cycle_.code == 89;
    To(feeds_out ? NcStep::kFeed : NcStep::kRapid, clear);
    if (cycle_.code == 86) Add(NcStep::kSpindleStart);
  }

  std::vector<NcCycleStep> Take() { return std::move(steps_); }

 private:
  const NcCycle& cycle_;
  std::array<int, 3> axes_;
  std::size_t line_number_;
  Vector3d at_;
  std::vector<NcCycleStep> steps_;
};

}  // namespace

bool IsCycle(int code_times_10) {
  switch (code_times_10) {
    case 730:
    case 810:
    case 820:
    case 830:
    case 850:
    case 860:
    case 890:
      return true;
    default:
      return false;
  }
}

std::vector<NcCycleStep> StepsOf(const NcCycle& cycle, const Vector3d& from,
                                 std::size_t line_number) {
  if (cycle.r < cycle.bottom) {
    RefuseLine(line_number, fmt::format("the cycle begins at R {:.9g}, below its bottom {:.9g}",
                                        cycle.r, cycle.bottom));
  }
  if ((cycle.code == 73 || cycle.code == 83) && !(cycle.peck > 0.0)) {
    RefuseLine(line_number, "a cycle with pecks takes Q above 0");
  }
  CycleMoves moves(cycle, from, line_number);
  if (cycle.initial < cycle.r) moves.To(NcStep::kRapid, cycle.r);
  const double clear = cycle.retracts_to_r ? cycle.r : std::max(cycle.initial, cycle.r);
  for (const Eigen::Vector2d& hole : cycle.holes) {
    moves.Over(hole.x(), hole.y());
    if (moves.Normal() != cycle.r) moves.To(NcStep::kRapid, cycle.r);
    moves.Hole(cycle.r, cycle.bottom, clear);
  }
  return moves.Take();
}

}  // namespace abbe::compensation
