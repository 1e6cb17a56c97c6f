#include "probes/published_simulations.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "failure/failure.h"
#include "probes/simulation_sums.h"

namespace abbe::probes {
namespace {

constexpr int kMostThreads = 1024;  // TBB fails on many more
// A chunk of blocks is one task.
constexpr std::size_t kBlocksPerChunk = 256;

ErrorStatistics Statistics(const Sums& sums, std::size_t c, std::uint64_t draws) {
  double worst = 0, sum = 0, squares = 0;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    worst = std::max(worst, sums.worst[c][lane]);
    sum += sums.sum[c][lane];
    squares += sums.squares[c][lane];
  }
  const double n = draws, mean = sum / n;
  return {worst, mean, std::sqrt(std::max(0.0, squares / n - mean * mean))};
}

}  // namespace

SimulationErrors RunSimulation(const SimulationOptions& options) {
  if (options.draws == 0) throw InputError("simulation: 0 draws; ask for one or more");
  if (options.threads < 0) throw InputError("simulation: threads must be 0 (all) or more");
  constexpr std::uint64_t kChunk = kBlock * kBlocksPerChunk;
  const std::uint64_t chunks = (options.draws + kChunk - 1) / kChunk;
  std::vector<Sums> parts(chunks);
  const int threads = options.threads == 0 ? tbb::info::default_concurrency()
                                           : std::min(options.threads, kMostThreads);
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, threads);
  tbb::task_arena arena(threads);
  arena.execute([&] {
    tbb::parallel_for(std::uint64_t{0}, chunks, [&](std::uint64_t chunk) {
      const std::uint64_t first = chunk * kChunk;
      parts[chunk] = SumsOf(options, first, std::min(first + kChunk, options.draws));
    });
  });
  Sums sums;
  for (const Sums& part : parts) sums.Add(part);
  SimulationErrors errors;
  for (std::size_t c = 0; c < kPublishedComponents; ++c)
    errors[c] = Statistics(sums, c, options.draws);
  return errors;
}

}  // namespace abbe::probes
