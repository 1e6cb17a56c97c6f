// Time of one inversion of five readings: the closed forms of abbe, and beside them a plain scalar
// iteration that solves the same equations. Targets: 100 ns for the small-angle model, 250 ns with
// full rotations, 5 ns a station for many of the small-angle model, one core, no -march=native.
#include "probes/head_inversion.h"

#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "random/counter_random.h"
#include "width.h"

namespace {

using abbe::probes::HeadErrors;
using abbe::probes::HeadLayout;
using abbe::probes::MovingBody;
using abbe::probes::PerProbe;

constexpr std::size_t kSets = 1024;  // a power of two

struct ReadingSet {
  PerProbe<> delta;
  double d;
};

template <typename Model>
std::vector<ReadingSet> MakeSets(const Model& model) {
  const abbe::random::CounterRandom random(1, 1);
  std::vector<ReadingSet> sets;
  for (std::size_t i = 0; i < kSets; ++i) {
    const auto in = [&](std::size_t k, double size) {
      return random.Uniform(8 * i + k, -size, size);
    };
    const HeadErrors<> e{in(0, 1e-3), in(1, 1e-3), in(2, 1e-3), in(3, 50e-6), in(4, 50e-6), 0};
    const double d = random.Uniform(8 * i + 5, 0, 60e-3);
    sets.push_back({model(e, d), d});
  }
  return sets;
}

PerProbe<> SmallAngle(const HeadErrors<>& e, double d) {
  return SmallAngleReadings(abbe::probes::NominalLayout(), MovingBody::kTarget, e, d);
}
PerProbe<> Rigid(const HeadErrors<>& e, double d) {
  return RigidReadings(LinesOf(abbe::probes::NominalLayout()), MovingBody::kTarget, e, d);
}

// The plain way: the published first-order inversion, corrected by what the model reads too much
// until nothing changes any more.
template <typename Model>
HeadErrors<> Iterate(const Model& model, const PerProbe<>& delta, double d) {
  constexpr double kArm = 10e-3, kSideHeight = 20e-3;
  HeadErrors<> e;
  for (int i = 0; i < 20; ++i) {
    const PerProbe<> now = model(e, d);
    PerProbe<> r;
    double largest = 0;
    for (std::size_t k = 0; k < r.size(); ++k) {
      r[k] = delta[k] - now[k];
      largest = std::max(largest, std::abs(r[k]));
    }
    if (largest < 1e-17) break;
    const double middle = (r[1] + r[2]) / 2;
    const double eax = (r[1] - r[2]) / (2 * kArm), ebx = (middle - r[0]) / kArm;
    const double ecx = (r[4] - r[3]) / kArm;
    e.eax += eax;
    e.ebx += ebx;
    e.ecx += ecx;
    e.eyx += r[3] + kSideHeight * eax + d * ecx;
    e.ezx += middle - d * ebx;
  }
  return e;
}

template <typename Model, typename Invert>
void Run(benchmark::State& state, const Model& model, const Invert& invert) {
  const std::vector<ReadingSet> sets = MakeSets(model);
  std::size_t i = 0;
  for (auto _ : state) {
    const ReadingSet& set = sets[i++ & (kSets - 1)];
    benchmark::DoNotOptimize(invert(set.delta, set.d));
  }
}

void SmallAngleClosedForm(benchmark::State& state) {
  Run(state, SmallAngle,
      abbe::probes::SmallAngleInversion(abbe::probes::NominalLayout(), MovingBody::kTarget));
}
void SmallAngleIteration(benchmark::State& state) {
  Run(state, SmallAngle,
      [](const PerProbe<>& delta, double d) { return Iterate(SmallAngle, delta, d); });
}
void RigidClosedForm(benchmark::State& state) {
  Run(state, Rigid,
      abbe::probes::RigidInversion(LinesOf(abbe::probes::NominalLayout()), MovingBody::kTarget));
}
void RigidIteration(benchmark::State& state) {
  Run(state, Rigid, [](const PerProbe<>& delta, double d) { return Iterate(Rigid, delta, d); });
}
void Simplified(benchmark::State& state) {
  Run(state, SmallAngle,
      abbe::probes::SimplifiedInversion(abbe::probes::NominalLayout(), MovingBody::kTarget));
}

void SmallAngleBatch(benchmark::State& state) {
  using abbe::probes::SmallAngleInversion;
  const std::vector<ReadingSet> sets = MakeSets(SmallAngle);
  SmallAngleInversion::Readings readings(kSets, 5);
  Eigen::VectorXd d(kSets);
  for (Eigen::Index i = 0; i < readings.rows(); ++i) {
    for (Eigen::Index k = 0; k < 5; ++k) readings(i, k) = sets[i].delta[k];
    d[i] = sets[i].d;
  }
  const SmallAngleInversion invert(abbe::probes::NominalLayout(), MovingBody::kTarget);
  SmallAngleInversion::Errors errors;
  for (auto _ : state) {
    invert.Invert(readings, d, Eigen::VectorXd(), errors);
    benchmark::DoNotOptimize(errors.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kSets));
  state.counters["s_per_station"] =
      benchmark::Counter(static_cast<double>(kSets) * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

BENCHMARK(SmallAngleBatch);
BENCHMARK(SmallAngleClosedForm);
BENCHMARK(SmallAngleIteration);
BENCHMARK(RigidClosedForm);
BENCHMARK(RigidIteration);
BENCHMARK(Simplified);

}  // namespace

BENCHMARK_MAIN();
