// The data of a channel over one variable, reduced to parts of its range: enough to ask for every
// atom of the grammar at once.
//
//   for (const PartScan& scan : ScanParts(fit, channel)) BestOf(scan, form);
//
// The range of a variable is cut into kParts equal parts. One column for each part, and one hat for
// each border between them, through the projection of the fit (diagnosis/fit.h), give information S
// and score g of what the channel does there; a function f of the variable then has the information
// f'Sf and the score f'g: a step in parts, all others in hats, between which they count as
// straight. Under the fitted simulation g has the covariance S, priors and noise as the fit has
// them: draws of it are what the grammar finds in nothing.
// Units: SI for amounts, the unit of the variable for its values. Shapes: kParts, or one more hats.
// Failure: none.
// Source: score test, Rao, Proc. Cambridge Phil. Soc. 44 (1948).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "diagnosis/fit.h"
#include "learned/proposal.h"

namespace abbe::learned {

inline constexpr Eigen::Index kParts = 32;

struct PartScan {
  StageChannel channel;
  std::string variable;
  bool by_direction = false;  // times the sign of the motion of the variable
  bool hats = false;
  diagnosis::Range range;  // in the unit of the variable
  Eigen::VectorXd at;      // the middle of each part, the place of each hat
  Eigen::MatrixXd S;
  Eigen::VectorXd g;
};

std::vector<PartScan> ScanParts(const diagnosis::Fit& fit, const StageChannel& channel);

// An atom at the places of the parts; two rows for a wave.
Eigen::MatrixXd OverParts(const Atom& atom, const PartScan& scan);

struct Asked {
  Atom atom;
  double chi_square = 0.0;
};
// The number of a form with which most is explained; chi-square 0: nothing.
Asked BestOf(const PartScan& scan, Atom::Form form);

// All forms that can be asked of parts.
bool IsAskedOfParts(Atom::Form form);

// The largest log of a chance (that of one atom alone) over the whole grammar, for each of `draws`
// draws of nothing; the least of them first. Channels and variables are drawn independently, which
// is the safe side (Sidak's inequality).
std::vector<double> LeastChances(const std::vector<PartScan>& scans, int draws, std::uint64_t seed);

// ln of the probability of chi-square with 1 or 2 degrees of freedom.
double LogChanceOf(double chi_square, std::size_t columns);

}  // namespace abbe::learned
