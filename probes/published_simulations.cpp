#include "probes/published_simulations.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "failure/failure.h"
#include "probes/head_inversion.h"
#include "probes/installation.h"
#include "random/counter_words.h"

namespace abbe::probes {
namespace {

constexpr double kAngle = 1e-3;          // rad
constexpr double kStraightness = 50e-6;  // m
constexpr std::size_t kStations = 61;
constexpr double kPlaceRadius = 10e-6;  // m
constexpr Installation<> kInstallation{
    .pitch = 2e-3, .yaw = 2e-3, .du = 50e-6, .ds = 50e-6, .dn = 50e-6};

// Draws are made and evaluated in blocks that fit the first-level cache; a chunk of blocks is one
// task.
constexpr int kMostThreads = 1024;  // TBB fails on many more
constexpr std::size_t kBlock = 256;
constexpr std::size_t kBlocksPerChunk = 256;
// Sums are kept in lanes, so that their order is fixed and the compiler can use vector
// instructions.
constexpr std::size_t kLanes = 4;

using Column = std::array<double, kBlock>;

struct Draws {
  std::array<Column, kPublishedComponents> errors;
  Column d;
  std::array<std::uint32_t, 2 * kPublishedComponents * kBlock> words;

  HeadErrors<> Errors(std::size_t i) const {
    return {.eax = errors[kEax][i],
            .ebx = errors[kEbx][i],
            .ecx = errors[kEcx][i],
            .eyx = errors[kEyx][i],
            .ezx = errors[kEzx][i]};
  }
};

struct Sums {
  std::array<std::array<double, kLanes>, kPublishedComponents> worst{}, sum{}, squares{};

  void Add(const Sums& other) {
    for (std::size_t c = 0; c < kPublishedComponents; ++c) {
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        worst[c][lane] = std::max(worst[c][lane], other.worst[c][lane]);
        sum[c][lane] += other.sum[c][lane];
        squares[c][lane] += other.squares[c][lane];
      }
    }
  }
};

// Uniform in (-1, 1): the word read as a signed number, in the middle of its interval.
double Centred(std::uint32_t word) { return (static_cast<std::int32_t>(word) + 0.5) * 0x1.0p-31; }

void Draw(const SimulationOptions& options, std::uint64_t first, Draws& draws) {
  const bool one = options.simulation == Simulation::kOne;
  const std::size_t words = (one ? 1 : 2) * kPublishedComponents;
  const double step = (one ? 60e-3 : 10e-3) / (kStations - 1);
  random::FillWords(options.seed, one ? 1 : 2, first * words / 4,
                    std::span(draws.words).first(words * kBlock));
  for (std::size_t c = 0; c < kPublishedComponents; ++c) {
    const double size = c < kEyx ? kAngle : kStraightness;
    for (std::size_t i = 0; i < kBlock; ++i) {
      draws.errors[c][i] = size * Centred(draws.words[c * kBlock + i]);
    }
  }
  const int station = static_cast<int>(first % kStations);
  for (int i = 0; i < static_cast<int>(kBlock); ++i) {
    draws.d[i] = step * ((station + i) % static_cast<int>(kStations));
  }
}

// The nominal layout with every probe moved by kPlaceRadius in the direction of its word of draw i.
HeadLayout<> DrawnLayout(const HeadLayout<>& nominal, const Draws& draws, std::size_t i) {
  HeadLayout<> layout = nominal;
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    const std::uint32_t word = draws.words[(kPublishedComponents + probe) * kBlock + i];
    const double angle = std::numbers::pi * Centred(word);
    const double du = kPlaceRadius * std::cos(angle), dv = kPlaceRadius * std::sin(angle);
    if (probe < kTopProbes) {
      layout.top[probe].u += du;
      layout.top[probe].s += dv;
    } else {
      layout.side[probe - kTopProbes].u += du;
      layout.side[probe - kTopProbes].n += dv;
    }
  }
  return layout;
}

// error = estimated - true for the draws of one block, written over the true values.
template <typename Estimate>
[[gnu::flatten]] void Evaluate(Draws& draws, const Estimate& estimate) {
  for (std::size_t i = 0; i < kBlock; ++i) {
    const HeadErrors<> e = draws.Errors(i);
    const HeadErrors<> found = estimate(i, e, draws.d[i]);
    draws.errors[kEax][i] = found.eax - e.eax;
    draws.errors[kEbx][i] = found.ebx - e.ebx;
    draws.errors[kEcx][i] = found.ecx - e.ecx;
    draws.errors[kEyx][i] = found.eyx - e.eyx;
    draws.errors[kEzx][i] = found.ezx - e.ezx;
  }
}

// The layouts and inversions are copied into the loops: nothing that a loop writes can then change
// them, and the compiler can use vector instructions.
template <typename Invert>
void EvaluateWith(Simulation simulation, Draws& draws, const Invert& invert) {
  const HeadLayout<> nominal = NominalLayout();
  if (simulation == Simulation::kOne) {
    Evaluate(draws, [nominal, invert](std::size_t, const HeadErrors<>& e, double d) {
      return invert(nominal, SmallAngleReadings(nominal, MovingBody::kTarget, e, d), d);
    });
  } else {
    Evaluate(draws, [&](std::size_t i, const HeadErrors<>& e, double d) {
      const auto layout = InstalledLayout(DrawnLayout(nominal, draws, i), kInstallation);
      return invert(layout, SmallAngleReadings(layout, MovingBody::kTarget, e, d), d);
    });
  }
}

void EvaluateBlock(const SimulationOptions& options, Draws& draws) {
  const auto with = [&](const auto& invert) { EvaluateWith(options.simulation, draws, invert); };
  switch (options.inversion) {
    case Inversion::kSimplified:
      return with([simplified = SimplifiedInversion(NominalLayout(), MovingBody::kTarget)](
                      const HeadLayout<>&, const PerProbe<>& readings, double d) {
        return simplified(readings, d);
      });
    case Inversion::kExact:
      return with([exact = SmallAngleInversion(NominalLayout(), MovingBody::kTarget)](
                      const HeadLayout<>&, const PerProbe<>& readings, double d) {
        return exact(readings, d);
      });
    case Inversion::kCalibrated:
      return with([](const HeadLayout<>& layout, const PerProbe<>& readings, double d) {
        return SmallAngleInversion(layout, MovingBody::kTarget)(readings, d);
      });
  }
}

void AddBlock(const Draws& draws, Sums& sums) {
  for (std::size_t c = 0; c < kPublishedComponents; ++c) {
    const Column& errors = draws.errors[c];
    auto worst = sums.worst[c], sum = sums.sum[c], squares = sums.squares[c];
    for (std::size_t i = 0; i < kBlock; i += kLanes) {
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const double error = errors[i + lane];
        const double size = std::abs(error);
        worst[lane] = worst[lane] > size ? worst[lane] : size;
        sum[lane] += error;
        squares[lane] += error * error;
      }
    }
    sums.worst[c] = worst;
    sums.sum[c] = sum;
    sums.squares[c] = squares;
  }
}

Sums RunChunk(const SimulationOptions& options, std::uint64_t first, std::uint64_t end) {
  Sums sums;
  Draws draws;
  for (; first < end; first += kBlock) {
    Draw(options, first, draws);
    EvaluateBlock(options, draws);
    const std::ptrdiff_t count = std::min<std::uint64_t>(kBlock, end - first);
    for (Column& errors : draws.errors) std::fill(errors.begin() + count, errors.end(), 0.0);
    AddBlock(draws, sums);
  }
  return sums;
}

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
      parts[chunk] = RunChunk(options, first, std::min(first + kChunk, options.draws));
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
