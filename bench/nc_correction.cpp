// Blocks per second of the NC correction on one core, G1 lines of 0.6 mm. Target: 1 million/s.
#include "compensation/nc_correction.h"

#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>
#include <string>
#include <string_view>

#include "machine/configurations.h"
#include "map/error_map.h"

namespace {

using namespace abbe;
using Eigen::Vector3d;

constexpr double kTravel = 0.5;  // m

map::ErrorMap Column() {
  machine::VolumetricModel model(machine::ChainOf("column"),
                                 {{{0, kTravel}, {0, kTravel}, {0, kTravel}}});
  const auto form = machine::MakeBSplineForm(geometry::BSplineBasis::Uniform(3, 0.0, kTravel, 12));
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    for (int motion = 0; motion < machine::kMotions; ++motion) model.SetForm(axis, motion, form);
  }
  Eigen::VectorXd p(model.ParameterCount());
  for (Eigen::Index i = 0; i < p.size(); ++i) p[i] = 20e-6 * std::cos(1.7 * static_cast<double>(i));
  model.SetParameters(p);
  return {{}, model, {}};
}

void ShortLines(benchmark::State& state) {
  const compensation::Corrector corrector(Column(), Vector3d::Zero());
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
