#include "simulation/linkage/linkage_cells.h"

#include <cmath>
#include <numbers>

namespace abbe::simulation {

using Eigen::Index;

void CellMeans::Add(const LinkageRun& part, Index pose, const Eigen::Vector3d& gap, double weight) {
  if (cells_.empty()) like_ = Blank(part, 0);
  std::array<std::int64_t, 3> key{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double position = part.commanded(axis, pose);
    key[axis] = static_cast<std::int64_t>(std::floor(position / cell_));
  }
  const auto angles = part.readings.angles.col(pose);
  const auto [at, is_new] = cells_.try_emplace(key);
  Sums& sums = at->second;
  if (is_new) {
    sums.row = part.rows[pose];
    sums.first_angles = angles;
    sums.reference_sd = part.reference_sd.col(pose);
    sums.angles.setZero(angles.size());
  }
  sums.weight += weight;
  sums.squares += weight * weight;
  sums.encoder += weight * weight / part.samples[pose];
  sums.time += weight * part.time[pose];
  if (part.readings.warmth.size() > 0) sums.warmth += weight * part.readings.warmth[pose];
  sums.commanded += weight * part.commanded.col(pose);
  sums.gap += weight * gap;
  // An encoder may show a turn more.
  sums.angles += weight * (angles - sums.first_angles).unaryExpr([](double angle) {
    return std::remainder(angle, 2.0 * std::numbers::pi);
  });
}

LinkageRun CellMeans::Run() const {
  LinkageRun means = Blank(like_, cells_.size());
  Index pose = 0;
  for (const auto& [key, sums] : cells_) {
    means.rows[pose] = sums.row;
    means.time[pose] = sums.time / sums.weight;
    means.commanded.col(pose) = sums.commanded / sums.weight;
    means.reference.col(pose) = means.commanded.col(pose);
    means.reference_sd.col(pose) = std::sqrt(sums.squares) / sums.weight * sums.reference_sd;
    means.readings.angles.col(pose) = sums.first_angles + sums.angles / sums.weight;
    if (means.readings.warmth.size() > 0) means.readings.warmth[pose] = sums.warmth / sums.weight;
    means.samples[pose] = sums.weight * sums.weight / sums.encoder;
    ++pose;
  }
  return means;
}

Eigen::Matrix3Xd CellMeans::Gaps() const {
  Eigen::Matrix3Xd gaps(3, cells_.size());
  Index pose = 0;
  for (const auto& [key, sums] : cells_) gaps.col(pose++) = sums.gap / sums.weight;
  return gaps;
}

}  // namespace abbe::simulation
