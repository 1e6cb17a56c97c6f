// Points per second of the volumetric error on one core: exact, with all derivatives, and between
// the points of a grid. bench/volumetric_numpy.py runs this program and SciPy in one run on the
// same machine, and holds the mean error (the counter mean_um) of the two against each other.
// Targets: ten times SciPy, 30 million points/s on the grid, 5 million points/s with all derivatives
// in batch.
#include <benchmark/benchmark.h>

#include <cmath>

#include "column_machine.h"
#include "machine/volumetric_field.h"
#include "map/map_grid.h"
#include "width.h"

namespace {

using namespace abbe::machine;
using abbe::bench::ColumnMachine;
using abbe::bench::kTravel;
using Eigen::Vector3d;

constexpr Eigen::Index kPoints = 1 << 14;
const Vector3d kTool(0.05, -0.04, 0.1);

Eigen::Matrix3Xd Positions() {
  Eigen::Matrix3Xd positions(3, kPoints);
  for (Eigen::Index i = 0; i < kPoints; ++i) {
    for (int k = 0; k < 3; ++k) {
      positions(k, i) = kTravel / 2 * (1 + std::sin((k + 1.1) * static_cast<double>(i)));
    }
  }
  return positions;
}

void Exact(benchmark::State& state) {
  const VolumetricField field(ColumnMachine());
  const Eigen::Matrix3Xd positions = Positions();
  Eigen::Matrix3Xd errors;
  for (auto _ : state) {
    errors = field.Errors(positions, kTool);
    benchmark::DoNotOptimize(errors.data());
  }
  state.SetItemsProcessed(state.iterations() * kPoints);
  state.counters["mean_um"] = 1e6 * errors.mean();
}

void WithDerivatives(benchmark::State& state) {
  const VolumetricModel model = ColumnMachine();
  const Eigen::Matrix3Xd positions = Positions();
  for (auto _ : state) {
    for (Eigen::Index i = 0; i < kPoints; ++i) {
      benchmark::DoNotOptimize(model.Linearize(positions.col(i), kTool));
    }
  }
  state.SetItemsProcessed(state.iterations() * kPoints);
}

void WithDerivativesInBatch(benchmark::State& state) {
  const VolumetricField field(ColumnMachine());
  const Eigen::Matrix3Xd positions = Positions();
  VolumetricField::Linearized linear;
  for (auto _ : state) {
    field.Linearize(positions, kTool, linear);
    benchmark::DoNotOptimize(linear.error(0).data());
  }
  state.SetItemsProcessed(state.iterations() * kPoints);
}

void OnGrid(benchmark::State& state) {
  const abbe::map::MapGrid grid =
      abbe::map::SampleGrid({{}, ColumnMachine(), {}}, kTool, {51, 51, 51});
  const Eigen::Matrix3Xd positions = Positions();
  Eigen::Matrix3Xd errors(3, kPoints);
  for (auto _ : state) {
    for (Eigen::Index i = 0; i < kPoints; ++i) errors.col(i) = grid.Error(positions.col(i));
    benchmark::DoNotOptimize(errors.data());
  }
  state.SetItemsProcessed(state.iterations() * kPoints);
  state.counters["mean_um"] = 1e6 * errors.mean();
}

BENCHMARK(Exact);
BENCHMARK(WithDerivatives);
BENCHMARK(WithDerivativesInBatch);
BENCHMARK(OnGrid);

}  // namespace

BENCHMARK_MAIN();
