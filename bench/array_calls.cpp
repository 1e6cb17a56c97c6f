// Array calls of 10^5 rows as Python makes them, in C++: what bench/array_calls.py holds its own times
// against.
//
//   array_calls MAP [BENCHMARK OPTION...]
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "machine/volumetric_field.h"
#include "map/map_file.h"
#include "probes/head_inversion.h"
#include "probes/inversion_of_rows.h"
#include "relm/pivot_linkage.h"

namespace {

constexpr Eigen::Index kRows = 100000;
const char* map_file = nullptr;

// In [0, 1), the same in Python.
Eigen::MatrixXd Numbers(Eigen::Index columns) {
  Eigen::MatrixXd numbers(columns, kRows);
  for (Eigen::Index i = 0; i < numbers.size(); ++i) {
    numbers.data()[i] = std::fmod(0.618033988749895 * static_cast<double>(i + 1), 1.0);
  }
  return numbers;
}

void VolumetricError(benchmark::State& state) {
  const auto map = abbe::map::ReadMap(map_file);
  const abbe::machine::VolumetricField field(map.model());
  Eigen::Matrix3Xd positions = Numbers(3);
  for (int axis = 0; axis < 3; ++axis) {
    const auto& travel = map.model().travels()[axis];
    positions.row(axis).array() *= travel.last - travel.first;
    positions.row(axis).array() += travel.first;
  }
  for (auto _ : state) {
    const Eigen::Matrix3Xd errors = field.Errors(positions, map.origin().tool);
    benchmark::DoNotOptimize(errors.data());
  }
}

void LinkageTips(benchmark::State& state) {
  const abbe::relm::PivotLinkage linkage(0.12, 0.12);
  const Eigen::Matrix3Xd angles = Numbers(3);
  for (auto _ : state) {
    Eigen::Matrix3Xd tips;
    linkage.Tips(angles, tips);
    benchmark::DoNotOptimize(tips.data());
  }
}

void HeadInversion(benchmark::State& state) {
  using namespace abbe::probes;
  const Eigen::MatrixXd readings = 1e-6 * Numbers(5);
  const Eigen::MatrixXd travel = 0.06 * Numbers(1);
  for (auto _ : state) {
    const RigidInversion invert(LinesOf(NominalLayout()), MovingBody::kTarget);
    Eigen::Matrix<double, 6, Eigen::Dynamic> errors(6, kRows);
    for (Eigen::Index i = 0; i < kRows; ++i) {
      const double* row = readings.col(i).data();
      const auto e = invert({row[0], row[1], row[2], row[3], row[4]}, travel(0, i));
      errors.col(i) << e.eax, e.ebx, e.ecx, e.eyx, e.ezx, e.exx;
    }
    benchmark::DoNotOptimize(errors.data());
  }
}

void HeadSmallAngles(benchmark::State& state) {
  using namespace abbe::probes;
  const Eigen::MatrixXd readings = 1e-6 * Numbers(5);
  const Eigen::VectorXd travel = 0.06 * Numbers(1).row(0).transpose();
  for (auto _ : state) {
    const SmallAngleInversion invert(NominalLayout(), MovingBody::kTarget);
    ErrorRows errors(6, kRows);
    InvertRows(invert, readings, travel, Eigen::VectorXd(), errors);
    benchmark::DoNotOptimize(errors.data());
  }
}

BENCHMARK(VolumetricError);
BENCHMARK(LinkageTips);
BENCHMARK(HeadInversion);
BENCHMARK(HeadSmallAngles);

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (argc != 2) return 2;
  map_file = argv[1];
  benchmark::RunSpecifiedBenchmarks();
}
