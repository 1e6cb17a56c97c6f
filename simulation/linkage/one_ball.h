// Runs of a linkage or an arm under one name of their base are of one ball: refuses those that are
// not, which a fit would spread over all parameters.
//
//   OneBall ball("give recordings of one ball at a time");         // what to do otherwise
//   for (const recording::Recording& each : recordings) {
//     ball.Add(each, ReadLinkageRun(each, linkage));
//   }
//
// Two that state different balls (header mounting.ball) are refused for that. Else the data tell:
//
// Where two runs show the same angles the tip is at the same place, or moved with the base, which
// keeps all distances. Another ball sits elsewhere in the frame of the last link and goes round
// with it: distances between two poses change by up to that. Held against each other are distances
// of matching poses that follow each other; their median decides, so that gross readings do not.
// Frames: distances, in any frame.
// Units: m, rad. Shapes: runs of any length.
// Failure: InputError with both recordings and by how much.
// Source: own; distances between places do not depend on the frame of an instrument.
// Validity: from kFewest matching poses on (angles within kSameAngle); runs of other poses are
// taken as they are, and so is a ball that moved along with a hand that never turns, which is a
// base that moved.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "simulation/linkage/linkage_run.h"

namespace abbe::simulation {

class OneBall {
 public:
  static constexpr double kSameAngle = 1e-4;  // rad
  static constexpr double kApart = 1e-3;      // m: no noise, and no tolerance of a machine
  static constexpr Eigen::Index kFewest = 6;

  explicit OneBall(std::string advice) : advice_(std::move(advice)) {}

  // `recording`: for its header.
  void Add(const recording::Recording& recording, const LinkageRun& run);

 private:
  struct Known {
    std::string ball;  // empty: not stated
    LinkageRun run;
  };
  std::string advice_;
  std::vector<Known> known_;
};

}  // namespace abbe::simulation
