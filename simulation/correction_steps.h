// The parts of correction.h: what causes sum up to, and how a column is changed. For use within
// simulation/ only.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "simulation/correction.h"
#include "simulation/trace.h"

namespace abbe::simulation {

// What causes add to each row: those of the machine and those of its instruments.
struct Sums {
  Eigen::MatrixXd machine, instrument;  // kStages + pivots x rows
};
// Counts the time and the warmth of `trace` first.
Sums SumsOf(Trace& trace, const std::vector<ModelledCause>& causes, const Origin& origin);

// A column of a recording that is changed row by row; without such a column nothing happens.
class Moved {
 public:
  Moved(recording::Recording& recording, const std::string& name, Change& change);
  void By(std::size_t row, double change);  // SI

 private:
  double unit_;
  Change& change_;
  std::vector<double>* values_ = nullptr;
};

// The position columns "x_mm", "y_mm", "z_mm".
std::string PositionColumn(Eigen::Index axis);

}  // namespace abbe::simulation
