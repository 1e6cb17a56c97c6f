#include "paths/stays.h"

#include <algorithm>
#include <cmath>

namespace abbe::paths {

std::vector<Stay> Stays(const MeasuredPath& path, double window) {
  std::vector<Stay> stays;
  for (Eigen::Index begin = 0, end = 0; begin < path.poses(); begin = end) {
    const Eigen::Vector3d first = path.commanded.col(begin);
    for (end = begin + 1; end < path.poses(); ++end) {
      if ((path.commanded.col(end) - first).norm() > window) break;
    }
    if (end - begin < kLeastRows) continue;
    const Eigen::Index settled = begin + (end - begin) / 4, n = end - settled;
    const Eigen::Matrix3Xd measured = path.measured.middleCols(settled, n);
    const Eigen::Vector3d mean = measured.rowwise().mean();
    const Eigen::Vector3d squares = (measured.colwise() - mean).rowwise().squaredNorm();
    stays.push_back({path.commanded.middleCols(settled, n).rowwise().mean(), mean,
                     (squares / std::max<Eigen::Index>(1, n - 1)).cwiseSqrt(),
                     static_cast<std::size_t>(n)});
  }
  return stays;
}

}  // namespace abbe::paths
