// Body diagonals of a machine's volume after ISO 230-6: a quick check of all its errors together.
//
// Frames: a deviation is the distance measured along the diagonal minus its nominal, at the same
// targets in both directions. Units: m. Shapes: the mean deviation at each target of a diagonal;
// backward may be empty where it was not measured.
//
//   E_d   systematic deviation: largest minus smallest mean deviation of a diagonal, both
//         directions; of the machine the largest of its diagonals
//   B_d   reversal: largest |forward - backward| at a target
// Failure: InputError for fewer than two targets, lists of different length or numbers that are not
// finite.
// Source: ISO 230-6:2002, clause 3; not checked against its text. Validity: good diagonals do not
// prove a good volume: errors that cancel along all four remain undetected.
#pragma once

#include <span>
#include <vector>

namespace abbe::standards {

struct DiagonalRuns {
  std::vector<double> forward, backward;
};

struct DiagonalFigures {
  double E = 0.0, B = 0.0;
};

// E_d and B_d of one diagonal; B_d is 0 without backward runs.
DiagonalFigures EvaluateDiagonal(const DiagonalRuns& runs);

// E_d and B_d of the machine.
DiagonalFigures EvaluateDiagonals(std::span<const DiagonalRuns> diagonals);

}  // namespace abbe::standards
