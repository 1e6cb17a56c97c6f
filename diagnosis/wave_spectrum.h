// How strongly readings at any places vary like a wave, at all wave numbers at once.
//
//   const WaveGrid grid(length, highest);            // of the longest piece; waves per unit
//   Eigen::ArrayXd power = Eigen::ArrayXd::Zero(grid.waves());
//   for (const WaveRows& piece : pieces) power += grid.PowerOf(piece);
//   const double strongest = grid.WaveAt(index);
//
// Readings are put on the nearest point of a grid and transformed. Units: s, m or rad, and waves
// per unit. Validity: a wave at the highest number loses a fifth of its power by the grid.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace abbe::diagnosis {

// Rows of one stage: where they are, and what Fit::ScoresOf says of them.
struct WaveRows {
  Eigen::ArrayXd at, scores, weights;

  double length() const { return at.maxCoeff() - at.minCoeff(); }
};

class WaveGrid {
 public:
  WaveGrid(double length, double highest);

  Eigen::Index waves() const { return waves_; }
  // In steps of half a wave over the length.
  double WaveAt(Eigen::Index index) const { return index * step_; }
  double step() const { return step_; }
  // Chi-square of a wave of each number with a phase of its own, at least.
  Eigen::ArrayXd PowerOf(const WaveRows& piece) const;

 private:
  Eigen::Index points_, waves_;
  double step_, spacing_;
};

// Local maxima that exceed `least`, the largest first.
std::vector<Eigen::Index> PeaksOf(const Eigen::ArrayXd& power, double least);

}  // namespace abbe::diagnosis
