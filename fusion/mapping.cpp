#include "fusion/mapping.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "estimation/in_parallel.h"
#include "failure/failure.h"
#include "relm/tip_path.h"
#include "simulation/linkage/linkage_problem.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using simulation::LinkageRun;
using simulation::LinkageSimulation;
using GridPoint = std::array<int, 3>;

// The poses of a run by their place on the grid.
struct PoseGrid {
  std::array<std::vector<double>, 3> levels;
  std::map<GridPoint, std::vector<Index>> poses;
};

std::vector<double> LevelsOf(VectorXd positions) {
  std::sort(positions.begin(), positions.end());
  std::vector<double> levels;
  for (const double position : positions) {
    if (levels.empty() || position - levels.back() > kSameLevel) levels.push_back(position);
  }
  return levels;
}

int LevelAt(const std::vector<double>& levels, double position) {
  const auto above = std::upper_bound(levels.begin(), levels.end(), position);
  return static_cast<int>(above - levels.begin()) - 1;
}

PoseGrid GridOf(const Matrix3Xd& p_MT, const std::string& name) {
  PoseGrid grid;
  for (int axis = 0; axis < 3; ++axis) grid.levels[axis] = LevelsOf(p_MT.row(axis));
  const auto& levels = grid.levels;
  if (std::min({levels[0].size(), levels[1].size(), levels[2].size()}) < 3 ||
      std::ssize(levels[0]) * std::ssize(levels[1]) * std::ssize(levels[2]) > 4 * p_MT.cols()) {
    throw InputError(fmt::format(
        "{}: {} poses at {} x {} x {} positions form no grid; mapping needs a full grid of at "
        "least 3 x 3 x 3 axis positions",
        name, p_MT.cols(), levels[0].size(), levels[1].size(), levels[2].size()));
  }
  for (Index pose = 0; pose < p_MT.cols(); ++pose) {
    GridPoint point{};
    for (int axis = 0; axis < 3; ++axis) point[axis] = LevelAt(levels[axis], p_MT(axis, pose));
    grid.poses[point].push_back(pose);
  }
  return grid;
}

std::vector<Index> PosesAround(const PoseGrid& grid, const GridPoint& centre) {
  std::vector<Index> poses;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        const int steps = std::abs(x) + std::abs(y) + std::abs(z);
        if (steps != 0 && steps != 2) continue;
        const auto at = grid.poses.find({centre[0] + x, centre[1] + y, centre[2] + z});
        if (at != grid.poses.end()) {
          poses.insert(poses.end(), at->second.begin(), at->second.end());
        }
      }
    }
  }
  return poses;
}

// The global blocks with the estimates as nominal values and the base held.
VectorXd CellParameters(const LinkageSimulation& simulation, const LinkageRun& cell,
                        const VectorXd& x) {
  estimation::Problem problem = simulation::MakeLinkageProblem(
      simulation, {cell}, {.loss = estimation::RobustLoss::None()});  // too few rows to judge one
  Index at = 0;
  for (std::size_t b = 0; b < problem.blocks().size(); ++b) {
    auto& block = problem.Block({static_cast<int>(b)});
    for (auto& entry : block.entries) entry.nominal = entry.value = x[at++];
    if (b < 2) block.Hold();
  }
  const auto result = simulation::SolveLinkage(problem, 1);
  return simulation::ParametersOf(result.blocks, cell.mounting)
      .tail(simulation.model().parameters());
}

// The centres on either side of a position: index of the lower one and weight of the upper one.
std::pair<std::size_t, double> Between(const std::vector<double>& centres, double position) {
  if (centres.size() == 1 || position <= centres.front()) return {0, 0.0};
  if (position >= centres.back()) return {centres.size() - 2, 1.0};
  const std::size_t low = LevelAt(centres, position);
  return {low, (position - centres[low]) / (centres[low + 1] - centres[low])};
}

}  // namespace

MappedParameters MapParameters(const LinkageSimulation& simulation, const LinkageRun& run,
                               const VectorXd& x) {
  const PoseGrid grid = GridOf(simulation.Ball(run), run.name);
  MappedParameters mapped;
  std::vector<GridPoint> centres;
  for (int axis = 0; axis < 3; ++axis) {
    mapped.centres[axis].assign(grid.levels[axis].begin() + 1, grid.levels[axis].end() - 1);
  }
  const auto count = [&](int axis) { return static_cast<int>(mapped.centres[axis].size()); };
  for (int i = 1; i <= count(0); ++i) {
    for (int j = 1; j <= count(1); ++j) {
      for (int k = 1; k <= count(2); ++k) centres.push_back({i, j, k});
    }
  }
  mapped.values.resize(centres.size());
  estimation::InParallel(centres.size(), [&](std::size_t c) {
    const auto poses = PosesAround(grid, centres[c]);
    mapped.values[c] = x.tail(simulation.model().parameters());
    if (poses.empty()) return;
    mapped.values[c] = CellParameters(simulation, simulation::Selection(run, poses), x);
  });
  return mapped;
}

Matrix3Xd CellShifts(const LinkageSimulation& simulation, const LinkageRun& run, const VectorXd& x,
                     const MappedParameters& mapped) {
  const Matrix3Xd balls = simulation.Ball(run);
  const auto& [xs, ys, zs] = mapped.centres;
  const auto X_MB = simulation::BaseAt(simulation.settings().X_MB, x.head<6>());
  Matrix3Xd shifts(3, mapped.values.size());
  Index cell = 0;
  for (const double at_x : xs) {
    for (const double at_y : ys) {
      for (const double at_z : zs) {
        Index pose = 0;
        (balls.colwise() - Eigen::Vector3d(at_x, at_y, at_z)).colwise().norm().minCoeff(&pose);
        const double warmth = run.readings.warmth.size() == 0 ? 0.0 : run.readings.warmth[pose];
        const auto tip = [&](const VectorXd& values) {
          return simulation.model().Tip(run.readings.angles.col(pose), warmth, values);
        };
        shifts.col(cell) =
            X_MB.R * (tip(mapped.values[cell]) - tip(x.tail(simulation.model().parameters())));
        ++cell;
      }
    }
  }
  return shifts;
}

Matrix3Xd BlendedTips(const relm::LinkageModel& model, const geometry::Transform<double>& X_MB,
                      const VectorXd& values, const MappedParameters& mapped,
                      const relm::LinkageReadings& readings) {
  Matrix3Xd p_BT;
  model.Tips(readings, values, p_BT);
  const Matrix3Xd global = relm::InFrame(X_MB, p_BT);
  Matrix3Xd blended = Matrix3Xd::Zero(3, readings.poses());
  const auto size = [&](int axis) { return mapped.centres[axis].size(); };
  for (Index pose = 0; pose < readings.poses(); ++pose) {
    std::array<std::pair<std::size_t, double>, 3> at;
    for (int axis = 0; axis < 3; ++axis) {
      at[axis] = Between(mapped.centres[axis], global(axis, pose));
    }
    const double warmth = readings.warmth.size() == 0 ? 0.0 : readings.warmth[pose];
    for (unsigned corner = 0; corner < 8; ++corner) {
      double weight = 1.0;
      std::size_t cell = 0;
      for (int axis = 0; axis < 3; ++axis) {
        const unsigned upper = (corner >> axis) & 1U;
        weight *= upper == 1U ? at[axis].second : 1.0 - at[axis].second;
        cell = cell * size(axis) + at[axis].first + upper;
      }
      if (weight == 0.0) continue;
      blended.col(pose) +=
          weight * (X_MB * model.Tip(readings.angles.col(pose), warmth, mapped.values[cell]));
    }
  }
  return blended;
}

}  // namespace abbe::fusion
