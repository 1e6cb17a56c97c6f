// A cause at one object and with one shape, and what the data say of it.
// Units: SI. Shapes: coefficients and covariance as the cause has them, a free shape last.
// Failure: none.
// Source: docs/theory-diagnosis.md.
// Validity: evidence is that of evidence.h.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "diagnosis/campaign.h"
#include "simulation/causes/cause.h"

namespace abbe::diagnosis {

struct Candidate {
  const simulation::Cause* cause;
  simulation::Object object;
  Eigen::VectorXd shape;  // empty for a cause without
  // Around which its shape is varied; empty: it is kept.
  Eigen::VectorXd coefficients = {};
  double coarseness = 1.0;  // times the plausible sizes of the cause

  // "backlash:X".
  std::string Name() const { return cause->id + ":" + object.name(); }
  // Standard deviation of each coefficient, before any data.
  Eigen::VectorXd Plausible() const {
    return (cause->IsRandomField() ? shape[0] : coarseness) * cause->plausible;
  }
  // Whether the shape is a number between those tried, to be found with the coefficients.
  bool HasFreeShape() const {
    return cause->shapes && !cause->fixed_shapes && coefficients.size() > 0;
  }
  // Whether what it does is its coefficients times columns.
  bool HasColumns() const { return cause->columns && !cause->IsBinary(); }
};

// Whether one of the candidates has the name; shapes do not count.
bool IsAmong(const std::vector<Candidate>& candidates, const Candidate& candidate);

// Scale of the prior sizes of length-like causes (backlash, cyclic error, drift). The registry
// assumes a machine that positions to 2 um (the population of its file); a coarser one gets them in
// proportion.
double CoarsenessOf(const machine::Population& population);

// All causes at all objects of the scene, axes only where they travel, with all shapes to try. The
// shapes of one cause and object follow each other.
std::vector<Candidate> AllCandidates(const simulation::Scene& scene, double coarseness = 1.0);

// Those of a campaign: all causes, and what was learned on other machines.
std::vector<Candidate> CandidatesOf(const Campaign& campaign);

struct Score {
  Candidate candidate;
  Eigen::VectorXd coefficients;  // SI
  Eigen::MatrixXd covariance;    // of the coefficients, then of the logarithm of a free shape
  // Log of how much more probable the data are with the cause than without, all unknowns and the
  // coefficients integrated out.
  double log_evidence = 0.0;
  // Standard deviations by which a cause of plausible size stands out of everything else that the
  // simulation could be.
  double visible = 0.0;
  // Itself and others of its cause that fit nearly as well with another shape, most probable first
  // but for itself; empty: none does (alias_group.h).
  std::vector<Score> one_of = {};
};

// The keys of a score, SI, with their standard uncertainties to first order.
struct Keys {
  Eigen::VectorXd values, u;
};
// The covariance goes through `tell` by its derivatives.
Keys KeysOf(const Score& score);
// The key that lies beyond its physical bounds; null: none.
const simulation::CauseKey* BeyondBounds(const Score& score);

}  // namespace abbe::diagnosis
