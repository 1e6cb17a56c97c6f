// Simulations I and II of the head's paper: the errors of an inversion for random error motions.
//
//   const SimulationErrors errors =
//       RunSimulation({.simulation = Simulation::kOne, .inversion = Inversion::kSimplified});
//   errors[kEcx].worst;  // rad
//
// A draw takes EAX, EBX, ECX uniform in +-1 mrad, EYX, EZX uniform in +-50 um and EXX = 0,
// computes SmallAngleReadings for a moving target and inverts them; error = estimated - true. Draw
// i is at station i mod 61 of the travel, so 61 draws in a row are one run of the source.
//   kOne  d = 0 ... 60 mm, the nominal layout.
//   kTwo  d = 0 ... 10 mm, every probe displaced by 10 um in a random direction, the head
//         installed with yaw = pitch = 2 mrad and 50 um along u, s and n (the source's model has
//         neither roll nor the turn of the measuring lines). The inversion uses the nominal
//         layout, unless it is kCalibrated.
//
// Random numbers: 32-bit uniforms from the words of random/counter_words.h, five a draw in kOne,
// ten in kTwo; in each block of 256 draws, word 256 c + i is number c of draw i. The result is a
// pure function of simulation, inversion, draws and seed, to rounding where a processor has other
// vectors; it does not depend on the threads.
//
// Units: m and rad. Shapes: one ErrorStatistics for each of EAX, EBX, ECX, EYX, EZX.
// Failure: InputError for no draws or a negative number of threads.
// Source: Kweon, Liu, Yang (docs/theory-head.md), sections 5 and 6 and appendix; BoundsOf has its
// results.
// Validity: the largest of many draws grows with their number: compare runs of equal length.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace abbe::probes {

enum class Simulation { kOne, kTwo };

enum class Inversion {
  kSimplified,  // SimplifiedInversion, the source's
  kExact,       // SmallAngleInversion for the nominal layout
  kCalibrated,  // SmallAngleInversion for the actual layout; in kOne the same as kExact
};

struct SimulationOptions {
  Simulation simulation = Simulation::kOne;
  Inversion inversion = Inversion::kSimplified;
  std::uint64_t draws = 20000;
  std::uint64_t seed = 1;
  int threads = 0;  // 0: all
};

struct ErrorStatistics {
  double worst = 0;  // largest absolute value
  double mean = 0;
  double std = 0;  // about the mean
};

enum PublishedComponent : std::size_t { kEax, kEbx, kEcx, kEyx, kEzx };
inline constexpr std::size_t kPublishedComponents = 5;
inline constexpr std::array<const char*, kPublishedComponents> kComponentNames{"EAX", "EBX", "ECX",
                                                                               "EYX", "EZX"};
using SimulationErrors = std::array<ErrorStatistics, kPublishedComponents>;

// The largest errors that the source reports for the simplified inversion. For kOne it shows one
// run of 61 draws; of 20 000 draws the largest translation is 0.09 um.
struct PublishedBounds {
  double angle;        // rad
  double translation;  // m
};
// As the source states them, for both.
constexpr PublishedBounds BoundsOf(Simulation simulation) {
  return simulation == Simulation::kOne ? PublishedBounds{1e-6, 0.06e-6}
                                        : PublishedBounds{1.5e-5, 0.6e-6};
}

// All the draws; several threads.
SimulationErrors RunSimulation(const SimulationOptions& options);

}  // namespace abbe::probes
