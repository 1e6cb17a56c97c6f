// Poses per second of the linkage's kinematics on one core: closed form in batch and pose by pose,
// forward and inverse, the error models with and without Jacobian; beside them the same linkage as
// a product of 4 x 4 matrices, as one would first write it. bench/linkage_forward_numpy.py runs
// this program and NumPy in one run. Targets in batch: forward 10 million/s, inverse 5 million/s, and
// both twice as fast as NumPy.
#include <benchmark/benchmark.h>

#include <Eigen/Geometry>

#include "random/counter_random.h"
#include "relm/error_models.h"
#include "relm/pivot_linkage.h"
#include "width.h"

namespace {

using namespace abbe::relm;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double kLink = 0.120;  // m
constexpr Eigen::Index kPoses = 1 << 16;

// The ball anywhere in a cube of 100 mm, 180 mm from the base.
Matrix3Xd Places() {
  Matrix3Xd p(3, kPoses);
  for (Eigen::Index i = 0; i < kPoses; ++i) {
    for (int k = 0; k < 3; ++k) {
      p(k, i) = abbe::random::CounterRandom(1, k).Uniform(i, -0.05, 0.05) + (k == 0 ? 0.15 : 0.0);
    }
  }
  return p;
}

Matrix3Xd Angles() {
  Matrix3Xd q;
  std::vector<Reach> reach;
  PivotLinkage(kLink, kLink).AnglesOf(Places(), {}, q, reach);
  return q;
}

void CountPoses(benchmark::State& state, Eigen::Index poses) {
  state.SetItemsProcessed(state.iterations() * poses);
}

void ForwardBatch(benchmark::State& state) {
  const PivotLinkage linkage(kLink, kLink);
  const Matrix3Xd q = Angles();
  Matrix3Xd p;
  for (auto _ : state) {
    linkage.Tips(q, p);
    benchmark::DoNotOptimize(p.data());
  }
  CountPoses(state, kPoses);
}

void ForwardOneByOne(benchmark::State& state) {
  const PivotLinkage linkage(kLink, kLink);
  const Matrix3Xd q = Angles();
  for (auto _ : state) {
    for (Eigen::Index i = 0; i < kPoses; ++i) benchmark::DoNotOptimize(linkage.Tip(q.col(i)));
  }
  CountPoses(state, kPoses);
}

void ForwardByMatrices(benchmark::State& state) {
  using Eigen::AngleAxisd, Eigen::Isometry3d, Eigen::Translation3d;
  const Matrix3Xd q = Angles();
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  for (auto _ : state) {
    for (Eigen::Index i = 0; i < kPoses; ++i) {
      const Isometry3d X = Isometry3d(AngleAxisd(q(0, i), z)) * AngleAxisd(q(1, i), y) *
                           Translation3d(kLink * x) * AngleAxisd(q(2, i), y) *
                           Translation3d(kLink * z);
      benchmark::DoNotOptimize(Vector3d(X.translation()));
    }
  }
  CountPoses(state, kPoses);
}

void InverseBatch(benchmark::State& state) {
  const PivotLinkage linkage(kLink, kLink);
  const Matrix3Xd p = Places();
  Matrix3Xd q;
  std::vector<Reach> reach;
  for (auto _ : state) {
    benchmark::DoNotOptimize(linkage.AnglesOf(p, {}, q, reach));
  }
  CountPoses(state, kPoses);
}

void InverseOneByOne(benchmark::State& state) {
  const PivotLinkage linkage(kLink, kLink);
  const Matrix3Xd p = Places();
  for (auto _ : state) {
    for (Eigen::Index i = 0; i < kPoses; ++i) {
      benchmark::DoNotOptimize(linkage.FindAngles(p.col(i), {}));
    }
  }
  CountPoses(state, kPoses);
}

void Model(benchmark::State& state, ErrorModel which, bool with_jacobian) {
  constexpr Eigen::Index kSome = 588;  // of a calibration
  const auto document = abbe::settings::Document::Parse(
      "[linkage]\nform = \"pivots\"\n[linkage.base]\nposition_mm = [0, 0, 0]\n", "linkage.toml");
  const LinkageModel model = MakeLinkageModel(ReadLinkageSettings(document.Root()), which);
  const LinkageReadings readings{Angles().leftCols(kSome), {}};
  const Eigen::VectorXd x = model.Values();
  Matrix3Xd tips;
  RowMatrix jacobian;
  for (auto _ : state) {
    model.Tips(readings, x, tips, with_jacobian ? &jacobian : nullptr);
    benchmark::DoNotOptimize(tips.data());
  }
  CountPoses(state, kSome);
}

BENCHMARK(ForwardBatch);
BENCHMARK(ForwardOneByOne);
BENCHMARK(ForwardByMatrices);
BENCHMARK(InverseBatch);
BENCHMARK(InverseOneByOne);
BENCHMARK_CAPTURE(Model, published_24, ErrorModel::kPublishedWithBearing, false);
BENCHMARK_CAPTURE(Model, published_24_jacobian, ErrorModel::kPublishedWithBearing, true);
BENCHMARK_CAPTURE(Model, complete, ErrorModel::kComplete, false);
BENCHMARK_CAPTURE(Model, complete_jacobian, ErrorModel::kComplete, true);

}  // namespace

BENCHMARK_MAIN();
