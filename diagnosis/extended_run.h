// A simulated run that knows causes: its residual less what they add, with their coefficients as
// parameters of their own (block "cause backlash:X").
//
//   const LinearRun at = LinearAt(run, x, left);         // left: what the run leaves at x
//   const simulation::SimulatedRun knows = Extend(run, at, causes);
//
// The columns are those of the run at `x`, the parameters of its own blocks; the coefficients have
// their plausible deviation as prior. A cause that is there or not has no parameter; one that
// relaxes parameters changes their priors instead.
// Units, failure: those of simulation/simulated_run.h. Shapes: columns rows of the run x
// coefficients.
// Source: docs/theory-diagnosis.md.
// Validity: linear in the coefficients.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "diagnosis/campaign.h"
#include "diagnosis/candidate.h"

namespace abbe::diagnosis {

// A run at one x: what disturbances do to it there (nullptr for a run that does not tell), and its
// trace with the readings that it would show without noise.
struct LinearRun {
  simulation::Trace trace;
  std::shared_ptr<const simulation::Response> response;

  // The columns of a cause; empty when it does not act on this run.
  Eigen::MatrixXd Columns(const Candidate& cause) const;
};
// `left`: the whitened residual of the simulation with the causes; empty: the readings stay as they
// are. Binary causes among `causes` (swapped or inverted channels) are undone in the readings.
LinearRun LinearAt(const PreparedRun& run, const Eigen::VectorXd& x, const Eigen::VectorXd& left,
                   const std::vector<Candidate>& causes = {});

// With one block more for each cause; its residual is an estimation::ExtendedResidual.
simulation::SimulatedRun Extend(const PreparedRun& run, const LinearRun& at,
                                const std::vector<Candidate>& causes);

inline constexpr const char* kShapeEntry = "log_shape";  // beside where it was taken
inline constexpr double kShapeFree = 1.0;                // e-fold, its deviation: no bound

// A tolerance of zero holds a parameter, and the causes that widen it could never be found: it is
// free by a hundredth of what is usual of them instead.
void FreeForCauses(const simulation::Scene& scene, std::vector<estimation::ParameterBlock>& blocks);

// The name of the block of a cause.
std::string BlockOf(const Candidate& cause);

// Whether a parameter "head_turn X.u" is meant by "head_turn *.u".
bool Matches(const std::string& full_name, const std::string& pattern);

}  // namespace abbe::diagnosis
