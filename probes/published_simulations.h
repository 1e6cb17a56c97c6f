// Simulations I and II of the head's paper: how far an inversion is off under random errors.
//
//   const SimulationErrors errors =
//       RunSimulation({.simulation = Simulation::kOne, .inversion = Inversion::kSimplified});
//   errors[kEcx].worst;  // rad
//
// A draw: EAX, EBX, ECX uniform in +-1 mrad, EYX, EZX uniform in +-50 um; DocumentReadings of the
// nominal layout with a moving target; an inversion; error = estimated - true. Draw i stands at
// station i mod 61 of the travel, so 61 draws in a row are one run of the source. EXX = 0.
//   kOne  d = 0 ... 60 mm, the head as drawn,
//   kTwo  d = 0 ... 10 mm, every probe off its place by 10 um in a random direction, the head
//         installed with yaw = pitch = 2 mrad and 50 um along u, s and n (roll and the turn of the
//         measuring lines play no part in the source's model). The inversion knows the nominal
//         layout only, unless it is kCalibrated.
//
// Random numbers: 32-bit uniforms from the words of random/counter_words.h, five a draw in kOne,
// ten in kTwo; in each block of 256 draws, word 256 c + i is number c of draw i. The result is a
// pure function of simulation, inversion, draws and seed, whatever the number of threads.
//
// Units: m and rad.
// Failure: InputError for no draws or a negative number of threads.
// Source: Kweon, Liu, Yang (docs/theory-head.md), sections 5 and 6 and appendix. What it
// found is in BoundsOf.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace abbe::probes {

enum class Simulation { kOne, kTwo };

enum class Inversion {
  kSimplified,  // the source's, first order
  kExact,       // DocumentInversion for the nominal layout
  kCalibrated,  // DocumentInversion for the layout as it really stands; in kOne the same as kExact
};

struct SimulationOptions {
  Simulation simulation = Simulation::kOne;
  Inversion inversion = Inversion::kSimplified;
  std::uint64_t draws = 20000;
  std::uint64_t seed = 1;
  int threads = 0;  // 0: as many as there are
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
constexpr PublishedBounds BoundsOf(Simulation simulation) {
  return simulation == Simulation::kOne ? PublishedBounds{1e-6, 0.06e-6}
                                        : PublishedBounds{1.5e-5, 0.6e-6};
}

SimulationErrors RunSimulation(const SimulationOptions& options);

}  // namespace abbe::probes
