#include "simulation/points/reference_noise.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "failure/failure.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kOneTarget = 20e-6;  // m: nearer positions are of one target
constexpr double kRounding = 1e-12;   // m

// Numbers the targets; one entry per row.
std::vector<int> TargetsOf(const Eigen::RowVectorXd& position) {
  std::vector<Index> order(position.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return position[a] < position[b]; });
  std::vector<int> targets(order.size());
  int target = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i > 0 && position[order[i]] - position[order[i - 1]] > kOneTarget) ++target;
    targets[order[i]] = target;
  }
  return targets;
}

// Columns for each mean, offset and slope that there is; `position` from -1 to 1.
MatrixXd DesignOf(const ReferenceRun& run, const Eigen::RowVectorXd& position) {
  using Key = std::pair<int, int>;
  const std::vector<int> targets = TargetsOf(position);
  const double half = 0.5 * (position.maxCoeff() - position.minCoeff());
  const double middle = position.minCoeff() + half;
  std::map<Key, Index> means, ways;
  for (Index row = 0; row < run.rows(); ++row) {
    means.try_emplace({targets[row], run.direction[row]}, std::ssize(means));
    ways.try_emplace({run.pass[row], run.direction[row]}, std::ssize(ways));
  }
  const Index first_way = means.size();
  MatrixXd design = MatrixXd::Zero(run.rows(), first_way + 2 * ways.size());
  for (Index row = 0; row < run.rows(); ++row) {
    const Index way = first_way + 2 * ways.at({run.pass[row], run.direction[row]});
    design(row, means.at({targets[row], run.direction[row]})) = 1.0;
    design(row, way) = 1.0;
    design(row, way + 1) = (position[row] - middle) / half;
  }
  return design;
}

}  // namespace

std::optional<RepeatNoise> NoiseOfRepeats(const ReferenceRun& run) {
  if (run.tested == ' ') return std::nullopt;
  const Index along = run.tested - 'X';
  const MatrixXd design = DesignOf(run, run.points.axes.row(along));
  const Eigen::CompleteOrthogonalDecomposition<MatrixXd> fit(design);
  RepeatNoise noise{Eigen::Vector3d::Zero(), run.rows() - fit.rank()};
  if (noise.freedom < kLeastFreedom) return std::nullopt;
  for (Index axis = 0; axis < 3; ++axis) {
    if (!run.shown[axis]) continue;
    const Eigen::VectorXd deviation = (run.place - run.points.axes).row(axis).transpose();
    const Eigen::VectorXd left = deviation - design * fit.solve(deviation);
    noise.sd[axis] = std::sqrt(left.squaredNorm() / (noise.freedom - 2));
    if (noise.sd[axis] > kRounding) continue;
    throw InputError(fmt::format(
        "{}: ref_{}_mm repeats to its last digit in every cycle; state the noise of the reference "
        "as u_reference_um in its header",
        run.points.name, "xyz"[axis]));
  }
  return noise;
}

void SetNoise(const Eigen::Vector3d& sd, ReferenceRun& run) {
  for (Index axis = 0; axis < 3; ++axis) {
    if (!run.shown[axis]) continue;
    for (Index row = 0; row < run.rows(); ++row) {
      if (run.sd(axis, row) == 0.0) run.sd(axis, row) = sd[axis];
    }
  }
}

}  // namespace abbe::simulation
