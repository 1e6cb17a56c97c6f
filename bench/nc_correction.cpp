// Blocks per second of the NC correction on one core, G1 lines of 0.6 mm. Target: 1 million/s.
#include "compensation/nc_correction.h"

#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>
#include <string>
#include <string_view>

#include "column_machine.h"
#include "map/error_map.h"

namespace {

using namespace abbe;
using bench::kTravel;
using Eigen::Vector3d;

void ShortLines(benchmark::State& state) {
  const compensation::Corrector corrector({{}, bench::ColumnMachine(), {}}, Vector3d::Zero());
  std::string program;
  for (int i = 0; i < 1000; ++i) {
    const double t = 2e-3 * std::numbers::pi * i;
    program += "G1 X" + std::to_string(250 + 100 * std::cos(t)) + " Y" +
               std::to_string(250 + 100 * std::sin(t)) + "\n";
  }
  for (auto _ : state) {
    compensation::NcOptions options;
    options.limits = {1e-6, 0.01};
    options.start = Vector3d(0.35, 0.25, 0.1);
    compensation::NcSource source("", program);
    std::string out;
    compensation::CorrectProgram(corrector, options, source,
                                 [&](std::string_view piece) { out += piece; });
    benchmark::DoNotOptimize(out.data());
  }
  state.SetItemsProcessed(state.iterations() * 1000);
}

BENCHMARK(ShortLines);

}  // namespace

BENCHMARK_MAIN();
