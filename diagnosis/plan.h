// Which causes a set of runs would show, before anything is measured.
//
//   Campaign campaign(instruments);
//   for (const recording::Recording& path : paths) campaign.Add(Planned(path, instruments));
//   const Plan plan = PlanOf(campaign, normal);
//
// The machine that is measured is one drawn from what the machine file says of such machines, its
// head, target and linkage: a probe that sees no error shows none of its own. All it could be
// instead is projected out of each cause, as in fit.h, with the information of all runs. A cause
// with shapes is listed with the shape that stands out most, as in the list of what a diagnosis
// cannot show. Two causes are alike by the root mean square of the canonical correlations of their
// columns, over the directions of each that stand out at all; 1: they do the same.
// Units: SI. Shapes: one PlannedCause a cause and object.
// Failure: that of LinearRuns.
// Source: docs/theory-diagnosis.md.
// Validity: to first order; other machines of the same kind differ, most of all for causes of a
// probe's response.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "diagnosis/campaign.h"
#include "diagnosis/candidate.h"

namespace abbe::diagnosis {

struct PlannedCause {
  Candidate candidate;
  // Standard deviations by which a cause of plausible size stands out.
  double visible = 0.0;

  bool seen() const;
  // The keys, SI, of a cause of plausible size, and of one that stands out by kShowable; NaN where
  // it does not follow the size.
  struct Sizes {
    Eigen::VectorXd plausible, seen;
  };
  Sizes sizes() const;

  Eigen::Index coefficient = 0;  // that stands out most
};

struct Alike {
  std::size_t first, second;  // of the causes
  double cosine;
};

struct Plan {
  std::vector<PlannedCause> causes;   // in the order of the registry
  std::vector<Alike> alike;           // causes that show and cannot be separated, above kAlike
  std::vector<std::string> standing;  // names of pairs in which an axis never moves
};

inline constexpr double kAlike = 0.95;

// `normal`: the next of independent standard normal numbers.
Plan PlanOf(const Campaign& campaign, const std::function<double()>& normal);

// Root mean square of the canonical correlations of two sets of columns with the information `S`,
// the first `count` of it of the one, in units of what is plausible; 0 where nothing stands out.
double Likeness(const Eigen::MatrixXd& S, Eigen::Index count);

}  // namespace abbe::diagnosis
