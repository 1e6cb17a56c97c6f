// Reading a recording of 10^6 rows of a sweep, in bytes of the file (CSV) and of the numbers (HDF5)
// a second, beside the plain loop that one would write: fgets and strtod. `--memory csv|hdf5` reads
// one file once in a fresh process and prints the seconds and the peak of its memory instead.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "random/counter_random.h"
#include "recording/recording_file.h"

namespace {

using abbe::recording::Recording;

constexpr std::size_t kRows = 1'000'000;

// As an instrument writes: digits of a converter, times of a clock.
Recording Sweep() {
  const abbe::random::CounterRandom random(1, 1);
  Recording recording;
  recording.header = "kind = \"sweep\"\naxis = \"X\"\n";
  const auto add = [&](const std::string& name, auto value) {
    recording.columns.push_back({name, std::vector<double>(kRows)});
    for (std::size_t i = 0; i < kRows; ++i) recording.columns.back().values[i] = value(i);
  };
  add("time_s", [](std::size_t i) { return 0.005 * static_cast<double>(i); });
  add("x_mm", [](std::size_t i) { return 1e-5 * static_cast<double>(i * 6); });
  for (const char* name : {"y_mm", "z_mm"}) add(name, [](std::size_t) { return 30.00125; });
  add("pass", [](std::size_t i) { return static_cast<double>(i / 200'000 + 1); });
  add("direction", [](std::size_t i) { return i / 100'000 % 2 == 0 ? 1.0 : -1.0; });
  add("feed_mm_min", [](std::size_t) { return 600.0; });
  for (int probe = 0; probe < 5; ++probe) {
    add(std::string("probe_") + static_cast<char>('a' + probe) + "_um", [&](std::size_t i) {
      const double volt = random.Uniform(5 * i + static_cast<std::size_t>(probe), 20000.0, 45000.0);
      return 0.0030517578125 * static_cast<double>(static_cast<int>(volt));
    });
  }
  add("temp_column_c", [](std::size_t i) { return 20.0 + 0.01 * static_cast<double>(i / 5000); });
  add("flags", [](std::size_t) { return 0.0; });
  return recording;
}

const std::filesystem::path& File(const std::string& extension) {
  static const std::filesystem::path folder = std::filesystem::temp_directory_path() / "abbe-bench";
  static std::filesystem::path csv = folder / "sweep.csv";
  static std::filesystem::path hdf5 = folder / "sweep.h5";
  const std::filesystem::path& path = extension == "csv" ? csv : hdf5;
  if (!std::filesystem::exists(path)) {
    std::filesystem::create_directories(folder);
    abbe::recording::Write(Sweep(), path);
  }
  return path;
}

// The mean of every column stands for a reduction: it touches all numbers.
double Reduce(const Recording& recording) {
  double sum = 0.0;
  for (const auto& column : recording.columns) {
    for (const double value : column.values) sum += value;
  }
  return sum / static_cast<double>(recording.rows());
}

void Csv(benchmark::State& state) {
  const auto& path = File("csv");
  for (auto _ : state) benchmark::DoNotOptimize(Reduce(abbe::recording::Read(path)));
  state.SetBytesProcessed(
      static_cast<std::int64_t>(state.iterations() * std::filesystem::file_size(path)));
}
BENCHMARK(Csv)->Unit(benchmark::kMillisecond)->UseRealTime();

void Hdf5(benchmark::State& state) {
  const auto& path = File("hdf5");
  for (auto _ : state) benchmark::DoNotOptimize(Reduce(abbe::recording::Read(path)));
  state.SetBytesProcessed(
      static_cast<std::int64_t>(state.iterations() * kRows * 14 * sizeof(double)));
}
BENCHMARK(Hdf5)->Unit(benchmark::kMillisecond)->UseRealTime();

void PeerFgetsStrtod(benchmark::State& state) {
  const auto& path = File("csv");
  for (auto _ : state) {
    std::FILE* file = std::fopen(path.c_str(), "r");
    std::vector<std::vector<double>> columns(14);
    std::array<char, 4096> line;
    while (std::fgets(line.data(), line.size(), file) != nullptr) {
      if (line[0] == '#' || line[0] == 't') continue;
      char* at = line.data();
      for (auto& column : columns) {
        column.push_back(std::strtod(at, &at));
        ++at;
      }
    }
    std::fclose(file);
    benchmark::DoNotOptimize(columns);
  }
  state.SetBytesProcessed(
      static_cast<std::int64_t>(state.iterations() * std::filesystem::file_size(path)));
}
BENCHMARK(PeerFgetsStrtod)->Unit(benchmark::kMillisecond)->UseRealTime();

void PrintOnce(const std::string& form) {
  const auto begin = std::chrono::steady_clock::now();
  const double mean = Reduce(abbe::recording::Read(File(form)));
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  std::printf("%s: %.2f s, peak %ld MB (mean %g)\n", form.c_str(), time.count(),
              usage.ru_maxrss / 1000, mean);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3 && std::strcmp(argv[1], "--memory") == 0) {
    PrintOnce(argv[2]);
    return 0;
  }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
