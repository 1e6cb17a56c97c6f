// Time of one draw of Simulation I on one core. bench/simulation_i_numpy.py runs this program and
// the same simulation in NumPy, and prints the ratios of one run.
#include <benchmark/benchmark.h>

#include "probes/published_simulations.h"
#include "width.h"

namespace {

using abbe::probes::Inversion;

void SimulationI(benchmark::State& state, Inversion inversion) {
  const auto draws = static_cast<std::uint64_t>(state.range(0));
  for (auto _ : state) {
    benchmark::DoNotOptimize(abbe::probes::RunSimulation(
        {.inversion = inversion, .draws = draws, .seed = 1, .threads = 1}));
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}

BENCHMARK_CAPTURE(SimulationI, simplified, Inversion::kSimplified)
    ->Arg(10'000'000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(SimulationI, exact, Inversion::kExact)
    ->Arg(1'000'000)
    ->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
