// Things that are dragged along: they follow what moves them only where it takes them along.
// Units: those of what moves them. Failure: none. Validity: any speed, because nothing here has a
// mass; the steps must be short against a reversal.
#pragma once

#include <Eigen/Core>

namespace abbe::rig {

// A backlash element: the output follows the input by half of the width behind it.
class Play {
 public:
  explicit Play(double width) : half_(0.5 * width) {}
  // The output for an input; they are equal at the first call.
  double Follow(double drive);
  // From now on.
  void Widen(double width) { half_ = 0.5 * width; }

 private:
  double half_;
  bool begun_ = false;
  double driven_ = 0.0;
};

// The ball trails the cap by `displacement` against the last motion, also at rest: it is dragged
// like a weight on a string.
class DraggedBall {
 public:
  explicit DraggedBall(double displacement) : displacement_(displacement) {}
  // Ball minus cap, m, for a cap at `cap`; zero at the first call.
  Eigen::Vector3d Follow(const Eigen::Vector3d& cap);

 private:
  double displacement_;
  bool begun_ = false;
  Eigen::Vector3d ball_ = Eigen::Vector3d::Zero();
};

}  // namespace abbe::rig
