// What the runs say of the errors before their values: their sizes, their correlation lengths, and
// how noisy each run is.
//
//   const PopulationEstimate seen = EstimatePopulation(machine, model, runs);
//   seen.population.length(0, 4);       // of EBX, m
//   seen.noise[3];                      // of the fourth run, over what is stated
//   seen.statements.front().seen;       // what the runs say of a line of the machine file
//
// The logarithms of all sizes and lengths against those of the machine file are theta; their
// prior is normal around 0 with a standard deviation of 0.7 (a factor of two; of four at two
// standard deviations), half of its variance common to the whole machine: where the runs tell
// nothing of an error, it follows those that they tell of. Where the model holds waves of the
// positioning errors (machine_prior.h), theta has their sizes and lengths too, against 1 um and
// 1 mm, with standard deviations of log 4 and log 2 (own choice). theta maximises
//
//   log Z(theta) - theta' Pi theta / 2
//   log Z = (h' L (1 + L'HL)^-1 L'h - log det(1 + L' H L)) / 2
//
// H, h: information of the runs on the functions, all other parameters marginalised, and its
// product with the value that fits it; L L' = V(theta), their prior covariance. Steps by Fisher
// scoring: with A = (V + H^-1)^-1 and b = h - H C h, C the posterior covariance,
//
//   d log Z / d theta_i = (b' V_i b - tr(A V_i)) / 2        F_ij = tr(A V_i A V_j) / 2
//
// from the best of several common lengths. Between the steps the noise of each run is set to what
// its rows leave: k^2 = (chi-square + n) / (redundancy + n), n = 20, where that differs from 1 by
// more than four standard deviations. The form of the target is k times what the file states, the
// prior of ln k normal with ln(form_known_to) as standard deviation; its posterior, taken as normal
// too (mean m, variance v), gives the root mean square exp(m + v), but no less than 1: 1.62 where
// the runs tell nothing of a form that is known to a factor of two (probes/sweep_uncertainty.h).
// Units: SI. Shapes: theta: a size and a length of each function, squareness and scale, waves.
// Failure: none.
// Source: Rasmussen and Williams (2006), 5.4; Bates et al., "Fitting linear mixed-effects models"
// (2015), for the idea.
// Validity: to first order in the parameters.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "estimation/linearization.h"
#include "fusion/population_evidence.h"

namespace abbe::fusion {

struct PopulationEstimate {
  Eigen::VectorXd theta;
  ErrorPopulation population;
  std::vector<double> noise;  // of each run
  double form = 1.0;          // of the target, over what is stated; at least 1
  std::vector<Statement> statements;
  // By how much the functions and squarenesses move with theta: columns that are independent of
  // each other, of one standard deviation.
  Eigen::MatrixXd by_theta;
  Quadratic seen;  // of the functions and squarenesses, with this noise and form
};

// The runs at one point x: their sums, whitened with the noise `stated` times `noise`.
struct LinearRuns {
  estimation::SourceSums prior;  // of all parameters but the functions
  std::vector<estimation::SourceSums> runs;
  std::vector<Eigen::Index> rows;       // of each run
  std::vector<double> noise;            // of each run
  Eigen::VectorXd theta;                // of an estimate before, to start from; or empty
  double squareness;                    // rad: standard deviation in `prior`
  std::vector<int> machine;             // columns of the functions and the squarenesses
  std::vector<int> form;                // columns of the form of the target: target_form.h
  double form_stated, form_known_to;    // m; a factor
  double form_times;                    // over what is stated, in their prior
  Eigen::VectorXd values, form_values;  // of these, at x
};

// `runs`: at the point where they are linear.
PopulationEstimate EstimatePopulation(const machine::Machine& machine,
                                      const machine::VolumetricModel& model,
                                      const LinearRuns& runs);

}  // namespace abbe::fusion
