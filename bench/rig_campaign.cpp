// How long the rig takes for a machine and for one sweep of 610 standstills with 60 rows each.
#include <benchmark/benchmark.h>

#include "rig/record_sweep.h"

namespace {

using namespace abbe;

settings::Document DemoMill() {
  return settings::Document::Read(ABBE_SOURCE_DIR "/machines/demo_mill.toml");
}

void DrawWorld(benchmark::State& state) {
  const rig::RigSettings settings = rig::ReadRigSettings(DemoMill().Root());
  std::uint64_t seed = 0;
  for (auto _ : state) benchmark::DoNotOptimize(rig::World(settings, seed++));
}
BENCHMARK(DrawWorld)->Unit(benchmark::kMillisecond);

void RecordSweep(benchmark::State& state) {
  const settings::Document document = DemoMill();
  const rig::World world(rig::ReadRigSettings(document.Root()), 1);
  const auto channels = rig::ChannelsOf(hal::ReadDevices(document.Root().Child("devices")));
  const rig::RecordSweepOptions options{.rate = 75.0, .moving = state.range(0) != 0};
  for (auto _ : state) benchmark::DoNotOptimize(rig::RecordSweep(world, 'X', channels, options));
}
BENCHMARK(RecordSweep)->ArgName("moving")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
