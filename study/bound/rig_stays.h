// Rows of a recording of the rig that stand at one place, in the same pass and direction: one
// reading. Units: m, s.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "recording/recording.h"

namespace abbe::study {

struct RigStay {
  std::size_t first, rows;
  Eigen::Vector3d position;
  double time;

  // A column's, over its rows.
  double MeanOf(const recording::Recording& recording, const std::string& column) const {
    const auto values = recording.At(column);
    double sum = 0.0;
    for (std::size_t row = first; row < first + rows; ++row) sum += values[row];
    return sum / static_cast<double>(rows);
  }
};

inline std::vector<RigStay> RigStaysOf(const recording::Recording& recording) {
  const auto x = recording.At("x_mm"), y = recording.At("y_mm"), z = recording.At("z_mm"),
             time = recording.At("time_s"), pass = recording.At("pass"),
             direction = recording.At("direction");
  std::vector<RigStay> stays;
  for (std::size_t row = 0; row < recording.rows(); ++row) {
    const Eigen::Vector3d here = 1e-3 * Eigen::Vector3d(x[row], y[row], z[row]);
    const bool same = row > 0 && (here - stays.back().position).norm() < 2e-5 &&
                      pass[row] == pass[row - 1] && direction[row] == direction[row - 1];
    if (!same) stays.push_back({row, 0, here, 0.0});
    RigStay& stay = stays.back();
    ++stay.rows;
    stay.time += (time[row] - stay.time) / static_cast<double>(stay.rows);
  }
  return stays;
}

}  // namespace abbe::study
