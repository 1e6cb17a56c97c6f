// What the data say of one number within a proposal: a place, a period, a time constant, a width.
//
//   const NumberPosterior place = PosteriorOf(fit, proposal, 0, grid);
//   place.best.proposal.atoms[0].numbers[0];            // its mean, where one place stands out
//
// The likelihood of the number is scanned finely about the one given, row by row, coefficients at
// their best; before any data it is even over the range of `grid`.
// Units: those of the atom. Failure: that of the fit. For use within learned/ only.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "learned/term_search.h"

namespace abbe::learned {

struct NumberPosterior {
  Rated best;                      // with the number that was found
  double log_share = 0.0;          // of the width of the posterior in the prior range
  double u95 = 0.0;                // two standard deviations
  Eigen::MatrixXd by_number = {};  // how much the coefficients spread with it: a covariance
};

NumberPosterior PosteriorOf(const diagnosis::Fit& fit, const Proposal& proposal, std::size_t atom,
                            const NumberGrid& grid);

}  // namespace abbe::learned
