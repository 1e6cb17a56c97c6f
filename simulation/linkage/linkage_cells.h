// A long run of the linkage gathered into cells of the travel: what a million rows on moving paths
// say, kept in a few thousand poses.
//
//   CellMeans means(cell);
//   means.Add(part, pose, gap, weight);               // for each pose of each part of the run
//   const LinkageRun cells = means.Run();   means.Gaps();     // one pose, mean gap for each cell
//
// A pose of the result stands at the mean position and mean angles of its rows. The mean of their
// gaps is not the gap at the mean: the machine's errors and the linkage bend within a cell. So the
// gaps are taken at parameters x that fit a sample already, and who uses the means moves the angles
// until the gap at x is the mean of the gaps. What is neglected is the bend of what x is off:
// (cell / correlation length)^2 / 24 of it, 0.3 % for a cell of a quarter.
// Noise of a mean, with weights w of the rows: encoders sum(w^2 / samples) / sum(w)^2, in
// `samples`; what is the same for a stay sum(w^2) / sum(w)^2 of its variance, in `reference_sd`.
// Units: m, rad. Shapes: one column or entry per pose. Memory: that of the cells that were entered.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>

#include "simulation/linkage/linkage_run.h"

namespace abbe::simulation {

class CellMeans {
 public:
  explicit CellMeans(double cell) : cell_(cell) {}

  // `gap`: of the pose, m; `weight` above 0.
  void Add(const LinkageRun& part, Eigen::Index pose, const Eigen::Vector3d& gap, double weight);

  LinkageRun Run() const;
  Eigen::Matrix3Xd Gaps() const;  // mean of each pose of Run()

 private:
  struct Sums {
    std::size_t row;               // of the first pose, and its
    Eigen::VectorXd first_angles;  // angles
    Eigen::Vector3d reference_sd;
    double weight = 0.0, squares = 0.0, encoder = 0.0, time = 0.0, warmth = 0.0;
    Eigen::Vector3d commanded = Eigen::Vector3d::Zero(), gap = Eigen::Vector3d::Zero();
    Eigen::VectorXd angles;  // off those of the first
  };

  double cell_;
  LinkageRun like_;  // without poses
  std::map<std::array<std::int64_t, 3>, Sums> cells_;
};

}  // namespace abbe::simulation
