// Time and memory of the reduction of a recording of 10^6 rows: in memory, from HDF5 and from CSV,
// on one core. Targets: 1 s from HDF5, 2 s from CSV, below 200 MB in all.
#include "probes/sweep_reduction.h"

#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "random/counter_random.h"
#include "recording/recording_file.h"

namespace {

using abbe::recording::Recording;

constexpr int kStations = 61, kPasses = 5;
constexpr int kRowsOfDwell = 1'000'000 / (kStations * kPasses * 2);

abbe::probes::SweepSetup Setup() {
  const auto document = abbe::settings::Document::Parse(R"(
name = "bench"
chain = "[w X Y b Z t]"
[axis]
X = {travel_mm = [0, 60], positive = "carriage"}
Y = {travel_mm = [0, 60], positive = "carriage"}
Z = {travel_mm = [0, 60]}
)",
                                                        "bench.toml");
  return abbe::probes::ReadSweepSetup(document.Root());
}

// A straight axis under white noise: the values do not matter to the time.
Recording MakeRecording() {
  const abbe::random::CounterRandom random(1, 1);
  Recording recording;
  recording.name = "bench";
  recording.header = "kind = \"sweep\"\nmachine = \"bench\"\naxis = \"X\"\n";
  for (const char* name :
       {"time_s", "x_mm", "y_mm", "z_mm", "pass", "direction", "feed_mm_min", "probe_a_um",
        "probe_b_um", "probe_c_um", "probe_d_um", "probe_e_um", "flags"}) {
    recording.columns.push_back({name, {}});
    recording.columns.back().values.reserve(1'000'000);
  }
  std::uint64_t index = 0;
  double time = 0.0;
  for (int pass = 1; pass <= kPasses; ++pass) {
    for (const int direction : {1, -1}) {
      for (int k = 0; k < kStations; ++k) {
        const double at = direction > 0 ? k : kStations - 1 - k;
        for (int row = 0; row < kRowsOfDwell; ++row) {
          std::size_t column = 0;
          const auto add = [&](double value) {
            recording.columns[column++].values.push_back(value);
          };
          for (const double value :
               {time += 0.001, at, 0.0, 0.0, 1.0 * pass, 1.0 * direction, 600.0}) {
            add(value);
          }
          for (int probe = 0; probe < 5; ++probe) {
            add(std::round(1e3 * (100.0 + 0.02 * random.Normal(index++))) / 1e3);
          }
          add(0.0);
        }
      }
    }
  }
  return recording;
}

std::string WrittenTo(const std::string& extension) {
  const auto path = std::filesystem::temp_directory_path() / ("abbe_bench_sweep" + extension);
  if (!std::filesystem::exists(path)) abbe::recording::Write(MakeRecording(), path);
  return path.string();
}

double PeakMegabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

void ReduceInMemory(benchmark::State& state) {
  const Recording recording = MakeRecording();
  const auto setup = Setup();
  for (auto _ : state) benchmark::DoNotOptimize(abbe::probes::ReduceSweep(recording, setup));
}

void ReduceFile(benchmark::State& state, const std::string& extension) {
  const std::string path = WrittenTo(extension);
  const auto setup = Setup();
  for (auto _ : state) {
    benchmark::DoNotOptimize(abbe::probes::ReduceSweep(abbe::recording::Read(path), setup));
  }
  state.counters["peak_MB"] = PeakMegabytes();
}

BENCHMARK_CAPTURE(ReduceFile, hdf5, ".h5")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(ReduceFile, csv, ".csv")->Unit(benchmark::kMillisecond);
BENCHMARK(ReduceInMemory)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
