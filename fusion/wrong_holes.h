// Holes of a plate read wrong, by dirt, a wrong seat or a moved bush: named, and left out.
//
//   WithoutHoles(setups, FindWrongHoles(machine, setups))
//
// All set-ups are linear in the machine, the poses and the form, H their information with the
// priors of the machine file, e what is left of all rows at the solution, s their noise. For a
// shift C of a reading, or of a hole in all set-ups (Rao, 1948; two numbers each),
//
//   g = C'e / s^2      S = C'C / s^2 - C'J H^-1 J'C / s^4      T = g' S^-1 g
//
// is chi-square with two degrees of freedom where nothing is wrong; s^2 is at least 1, as stated,
// and else what makes the median of T over the readings that of chi-square. The reading with the
// largest T above kWrong^2 goes, or its hole in all set-ups where that accounts for 16 more, and
// everything is solved anew. A reading is wrong only if it is three times as far off, root of T, as
// any that stays in its set-up. Where more than one of twenty readings of a set-up would go, none
// is wrong: something else does not fit.
// Frames: `off` in the plate, u and v, read less what all others say.
// Units: m. Shapes: one entry a reading; a wrong hole has one in each set-up.
// Failure: NumericalError where the readings cannot be predicted.
// Source: Rao, Proc. Cambridge Philosophical Society 44 (1948); Baarda's data snooping (1968).
// Validity: to first order on a perfect machine; what is less than ten standard deviations off
// stays, as noise.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "machine/machine.h"
#include "simulation/points/plate_simulation.h"

namespace abbe::fusion {

struct WrongHole {
  std::size_t setup;   // index
  Eigen::Index point;  // of the set-up
  int hole;            // its number
  Eigen::Vector2d off;
  double sigma;   // root of T
  bool anywhere;  // in all set-ups: the hole, not the reading
};

// In the order of the set-ups and points.
std::vector<WrongHole> FindWrongHoles(const machine::Machine& machine,
                                      const std::vector<simulation::PlateSetup>& setups);

std::vector<simulation::PlateSetup> WithoutHoles(std::vector<simulation::PlateSetup> setups,
                                                 const std::vector<WrongHole>& wrong);

}  // namespace abbe::fusion
