// Measured paths made by hand: where the axes were sent, and where an instrument saw them by a
// formula. m, m/s.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "paths/measured_path.h"

namespace abbe::paths {

using Seen = std::function<Eigen::Vector3d(const Eigen::Vector3d& commanded)>;

inline MeasuredPath HandMade(const std::vector<Eigen::Vector3d>& commanded, const Seen& seen) {
  MeasuredPath path;
  path.recording = "made.csv";
  path.instrument = "reference";
  path.seen = {true, true, true};
  const auto n = static_cast<Eigen::Index>(commanded.size());
  path.commanded.resize(3, n);
  path.measured.resize(3, n);
  path.time = Eigen::VectorXd::LinSpaced(n, 0.0, 0.01 * static_cast<double>(n - 1));
  path.feed = Eigen::VectorXd::Constant(n, 1e-3);
  path.pass = Eigen::VectorXi::Ones(n);
  path.direction = Eigen::VectorXi::Constant(n, MeasuredPath::kDirectionNotStated);
  for (Eigen::Index i = 0; i < n; ++i) {
    path.rows.push_back(static_cast<std::size_t>(i));
    path.commanded.col(i) = commanded[static_cast<std::size_t>(i)];
    path.measured.col(i) = seen(commanded[static_cast<std::size_t>(i)]);
  }
  return path;
}

// `count` points from a, b excluded.
inline void Go(std::vector<Eigen::Vector3d>& path, const Eigen::Vector3d& a,
               const Eigen::Vector3d& b, int count) {
  for (int i = 0; i < count; ++i) path.push_back(a + (b - a) * i / count);
}

}  // namespace abbe::paths
