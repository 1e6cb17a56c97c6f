#include "simulation/linkage_cells.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace abbe::simulation {

using Eigen::Index;

CellMeans::CellMeans(const LinkageRun& run, double cell) : run_(run), cell_(cell) {}

void CellMeans::Add(Index pose, const Eigen::Vector3d& gap, double weight) {
  std::array<std::int64_t, 3> key{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double position = run_.commanded(static_cast<Index>(axis), pose);
    key[axis] = static_cast<std::int64_t>(std::floor(position / cell_));
  }
  Sums& sums = cells_.try_emplace(key, Sums{.first = pose, .angles = {}}).first->second;
  if (sums.angles.size() == 0) sums.angles.setZero(run_.readings.angles.rows());
  sums.weight += weight;
  sums.squares += weight * weight;
  sums.encoder += weight * weight / run_.samples[pose];
  sums.time += weight * run_.time[pose];
  if (run_.readings.warmth.size() > 0) sums.warmth += weight * run_.readings.warmth[pose];
  sums.commanded += weight * run_.commanded.col(pose);
  sums.gap += weight * gap;
  // An encoder may show a turn more.
  const auto off = run_.readings.angles.col(pose) - run_.readings.angles.col(sums.first);
  sums.angles += weight * off.unaryExpr([](double angle) {
    return std::remainder(angle, 2.0 * std::numbers::pi);
  });
}

LinkageRun CellMeans::Run() const {
  std::vector<Index> first;
  for (const auto& [key, sums] : cells_) first.push_back(sums.first);
  LinkageRun means = Selection(run_, first);
  Index pose = 0;
  for (const auto& [key, sums] : cells_) {
    const double share = std::sqrt(sums.squares) / sums.weight;
    means.time[pose] = sums.time / sums.weight;
    means.commanded.col(pose) = sums.commanded / sums.weight;
    means.reference.col(pose) = means.commanded.col(pose);
    means.reference_sd.col(pose) *= share;
    means.readings.angles.col(pose) += sums.angles / sums.weight;
    if (means.readings.warmth.size() > 0) {
      means.readings.warmth[pose] = sums.warmth / sums.weight;
    }
    means.samples[pose] = sums.weight * sums.weight / sums.encoder;
    ++pose;
  }
  return means;
}

Eigen::Matrix3Xd CellMeans::Gaps() const {
  Eigen::Matrix3Xd gaps(3, static_cast<Index>(cells_.size()));
  Index pose = 0;
  for (const auto& [key, sums] : cells_) gaps.col(pose++) = sums.gap / sums.weight;
  return gaps;
}

std::vector<Index> SampleOf(Index poses, Index most, Index count) {
  std::vector<Index> sample;
  if (poses <= most) {
    for (Index pose = 0; pose < poses; ++pose) sample.push_back(pose);
    return sample;
  }
  // Multiples of the golden ratio spread evenly and meet no raster of a path.
  for (Index i = 0; i < count; ++i) {
    const double turn = static_cast<double>(i) * std::numbers::phi;
    sample.push_back(static_cast<Index>((turn - std::floor(turn)) * static_cast<double>(poses)));
  }
  std::sort(sample.begin(), sample.end());
  sample.erase(std::unique(sample.begin(), sample.end()), sample.end());
  return sample;
}

}  // namespace abbe::simulation
