// The draws of a simulation, their errors and the sums of these. Highway compiles what stands between
// HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each width of vectors, here by the compiler
// itself, and takes the widest that the processor has.
#include "probes/simulation_sums.h"

#include <cmath>
#include <numbers>

#include "probes/head_inversion.h"
#include "probes/installation.h"
#include "random/counter_words.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "probes/simulation_sums.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace abbe::probes::HWY_NAMESPACE {

constexpr double kAngle = 1e-3;          // rad
constexpr double kStraightness = 50e-6;  // m
constexpr std::size_t kStations = 61;
constexpr double kPlaceRadius = 10e-6;  // m
constexpr Installation<> kInstallation{
    .pitch = 2e-3, .yaw = 2e-3, .du = 50e-6, .ds = 50e-6, .dn = 50e-6};

using Column = std::array<double, kBlock>;

struct Draws {
  std::array<Column, kPublishedComponents> errors;
  const double* d;                                // of the draws
  std::array<double, kStations + kBlock> travel;  // again and again, from the first station on
  std::array<std::uint32_t, 2 * kPublishedComponents * kBlock> words;

  HeadErrors<> Errors(std::size_t i) const {
    return {.eax = errors[kEax][i],
            .ebx = errors[kEbx][i],
            .ecx = errors[kEcx][i],
            .eyx = errors[kEyx][i],
            .ezx = errors[kEzx][i]};
  }
};

// Uniform in (-1, 1): the word read as a signed number, in the middle of its interval.
double Centred(std::uint32_t word) { return (static_cast<std::int32_t>(word) + 0.5) * 0x1.0p-31; }

[[gnu::flatten]] void Draw(const SimulationOptions& options, std::uint64_t first, Draws& draws) {
  const bool one = options.simulation == Simulation::kOne;
  const std::size_t words = (one ? 1 : 2) * kPublishedComponents;
  random::FillWords(options.seed, one ? 1 : 2, first * words / 4,
                    std::span(draws.words).first(words * kBlock));
  for (std::size_t c = 0; c < kPublishedComponents; ++c) {
    const double size = c < kEyx ? kAngle : kStraightness;
    for (std::size_t i = 0; i < kBlock; ++i) {
      draws.errors[c][i] = size * Centred(draws.words[c * kBlock + i]);
    }
  }
  draws.d = draws.travel.data() + first % kStations;
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
  const double* const d = draws.d;
  for (std::size_t i = 0; i < kBlock; ++i) {
    const HeadErrors<> e = draws.Errors(i);
    const HeadErrors<> found = estimate(i, e, d[i]);
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

Sums BlockSums(const SimulationOptions& options, std::uint64_t first, std::uint64_t end) {
  Sums sums;
  Draws draws;
  const double step = (options.simulation == Simulation::kOne ? 60e-3 : 10e-3) / (kStations - 1);
  for (std::size_t i = 0; i < draws.travel.size(); ++i) {
    draws.travel[i] = step * static_cast<double>(i % kStations);
  }
  for (; first < end; first += kBlock) {
    Draw(options, first, draws);
    EvaluateBlock(options, draws);
    const std::ptrdiff_t count = std::min<std::uint64_t>(kBlock, end - first);
    for (Column& errors : draws.errors) std::fill(errors.begin() + count, errors.end(), 0.0);
    AddBlock(draws, sums);
  }
  return sums;
}

}  // namespace abbe::probes::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace abbe::probes {

HWY_EXPORT(BlockSums);

Sums SumsOf(const SimulationOptions& options, std::uint64_t first, std::uint64_t end) {
  return HWY_DYNAMIC_DISPATCH(BlockSums)(options, first, end);
}

}  // namespace abbe::probes
#endif  // HWY_ONCE
