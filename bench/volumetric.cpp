// Points per second of the volumetric error on one core: exact, with all derivatives, and between
// the points of a grid. bench/volumetric_numpy.py runs this program and SciPy in one run on the
// same machine, and holds the mean error (the counter mean_um) of the two against each other.
// Targets: ten times SciPy, 30 million points/s on the grid, 5 million points/s with all derivatives
// in batch.
#include <benchmark/benchmark.h>

#include <cmath>

#include "machine/configurations.h"
#include "machine/volumetric_field.h"
#include "map/map_grid.h"
#include "width.h"

namespace {

using namespace abbe::machine;
using Eigen::Vector3d;

constexpr double kTravel = 0.5;  // m
constexpr int kCoefficients = 12;
constexpr Eigen::Index kPoints = 1 << 14;
const Vector3d kTool(0.05, -0.04, 0.1);

// A column machine with 18 cubic B-splines of 12 coefficients.
VolumetricModel Column() {
  VolumetricModel model(ChainOf("column"), {{{0, kTravel}, {0, kTravel}, {0, kTravel}}});
  const SharedForm form =
      MakeBSplineForm(abbe::geometry::BSplineBasis::Uniform(3, 0.0, kTravel, kCoefficients));
  for (int axis = 0; axis < kAxes; ++axis) {
    for (int motion = 0; motion < kMotions; ++motion) model.SetForm(axis, motion, form);
  }
  Eigen::VectorXd p(model.ParameterCount());
  for (Eigen::Index i = 0; i < p.size(); ++i) p[i] = 20e-6 * std::cos(1.7 * static_cast<double>(i));
  model.SetParameters(p);
  return model;
}

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
  const VolumetricField field(Column());
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
  const VolumetricModel model = Column();
  const Eigen::Matrix3Xd positions = Positions();
  for (auto _ : state) {
    for (Eigen::Index i = 0; i < kPoints; ++i) {
      benchmark::DoNotOptimize(model.Linearize(positions.col(i), kTool));
    }
  }
  state.SetItemsProcessed(state.iterations() * kPoints);
}

void WithDerivativesInBatch(benchmark::State& state) {
  const VolumetricField field(Column());
  const Eigen::Matrix3Xd positions = Positions();
  VolumetricField::Linearized linear;
  for (auto _ : state) {
    field.Linearize(positions, kTool, linear);
    benchmark::DoNotOptimize(linear.error(0).data());
  }
  state.SetItemsProcessed(state.iterations() * kPoints);
}

void OnGrid(benchmark::State& state) {
  const abbe::map::MapGrid grid = abbe::map::SampleGrid({{}, Column(), {}}, kTool, {51, 51, 51});
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
