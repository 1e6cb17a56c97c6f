// The search for the term that explains most of what is left beside a fit: exhaustive over
// channels, variables and atoms, reproducible.
//
//   const std::vector<Rated> best = SearchTerms(fit, structures).best;
//   best.front().proposal.expression().Text();
//
// All atoms are asked over parts of their variables (part_scan.h), decays, lags, plays and products
// of two plain variables row by row; the best kMultiplied are multiplied with each other; the
// numbers of the best kRefined are refined row by row. Each proposal then has a
//   log evidence   its coefficients as draws of one size, all sizes from 1 nm (nrad) to 1 mm (mrad)
//                  alike, averaged over the range of its numbers (Laplace's approximation)
//   log prior      -k ln n of k atoms out of n, and that something is there at all
// Smooth functions compete (diagnosis/structure_question.h) with the prior odds that they have
// there.
// Units: SI. Failure: that of the fit.
// Source: description length: Rissanen, Automatica 14 (1978); docs/theory-diagnosis.md.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/fit.h"
#include "diagnosis/structure_question.h"
#include "learned/part_scan.h"
#include "learned/proposal.h"

namespace abbe::learned {

// What the data say of a proposal.
struct Rated {
  Proposal proposal;
  double chi_square = 0.0, log_evidence = 0.0, log_posterior = 0.0;
  Eigen::VectorXd coefficients = {};  // m or rad per unit of its term
  // U95 of the numbers of its atoms, and what they add to the covariance of the coefficients.
  std::vector<double> u95_of_numbers = {};
  Eigen::MatrixXd by_numbers = {};
  std::vector<std::string> alike = {};  // other stages where it does the same to these runs
};

struct TermSearch {
  std::vector<Rated> best;                   // most probable first
  std::vector<PartScan> scans;               // of all channels
  std::size_t asked_by_row = 0;              // beside the atoms over parts
  std::size_t channels = 0, structures = 0;  // asked
  // The smooth function with the most evidence, refined; none: nothing is smooth.
  std::optional<diagnosis::Found> smooth = {};
  double log_posterior_of_smooth = 0.0;
};

// `structures`: FindStructures(fit).
TermSearch SearchTerms(const diagnosis::Fit& fit, const std::vector<diagnosis::Found>& structures);

// The variable of a structure as terms have it: temperatures as they rose since the start.
std::string LearnableOf(const std::string& variable);

// Exactly, row by row.
std::vector<Rated> AskByRow(const diagnosis::Fit& fit, const std::vector<Proposal>& proposals);

}  // namespace abbe::learned
