// What may be the matter with a machine, with the probability of each before the next run: nothing,
// one of the known causes, or something that is in no catalogue.
//
//   const Worlds worlds = WorldsOf(now, scene, coarseness);
//   worlds.list[0].probability;        // that nothing is the matter
//
// Before any run: the prior odds of a diagnosis. Afterwards: what the diagnosis says of each cause.
// Something outside the catalogue stands here as a wave over each position, at each channel, for
// each of which a run that shows it is known to show others too.
// Units: SI. Shapes: one coefficient vector a world; worlds in the order of their coefficients.
// Failure: none.
// Source: priors: diagnosis/diagnose.h, diagnosis/something_else.h.
// Validity: one thing at a time beside the findings that are certain.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "diagnosis/candidate.h"
#include "diagnosis/diagnose.h"
#include "simulation/learned/learned_term.h"

namespace abbe::investigate {

inline constexpr const char *kNothing = "nothing", *kUnknown = "something unknown";

struct World {
  std::string name;   // "backlash:X", kNothing, or of something unknown "EYX over x"
  std::string group;  // between worlds of one group nothing is to be decided
  double probability = 0.0;
  // Empty of nothing: no candidate.
  std::shared_ptr<const diagnosis::Candidate> candidate = {};
  Eigen::VectorXd mean = {}, deviation = {};  // of the coefficients, if it is true
};

struct Worlds {
  std::vector<World> list;                    // the first is that nothing is the matter
  std::vector<diagnosis::Candidate> certain;  // findings beside all of them
  // Owners of the causes of what is unknown.
  std::vector<std::shared_ptr<const simulation::LearnedCause>> unknown;

  // bits; of the groups
  double Entropy() const;
};
double EntropyOf(const std::vector<World>& worlds, const Eigen::VectorXd& probabilities);

// `now`: none before the first run. `scene`: of all runs, those that could be made too.
Worlds WorldsOf(const diagnosis::Diagnosis* now, const simulation::Scene& scene, double coarseness);

// Weighs what no finding decides anew by what the runs would have shown: `S` is the information of
// all coefficients, world after world. Does nothing where something was found.
void WeighBySilence(const diagnosis::Diagnosis* now, const Eigen::MatrixXd& S, Worlds& worlds);

}  // namespace abbe::investigate
