// Runs made linear at one state of the machine, recorded or only planned: what any of them together
// would tell of causes.
//
//   const LinearRuns linear(campaign, runs, ValuesOf(fit.result()));
//   const RunSums first = linear.SumsOf(linear.At(0), candidates);
//   linear.Information({&first, &second});      // S of fit.h, of all coefficients in order
//
// The simulation of the runs with all its unknowns and their priors is that of fit.h; nothing
// is fitted and no reading counts. Unknowns of runs that are left out take no part.
// Units: SI; rows whitened. Failure: NumericalError for a run that cannot be simulated there.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "diagnosis/campaign.h"
#include "diagnosis/candidate.h"
#include "diagnosis/extended_run.h"
#include "estimation/linearization.h"
#include "estimation/problem.h"

namespace abbe::diagnosis {

// The values of the entries of blocks, by the name of the block.
using Values = std::map<std::string, Eigen::VectorXd>;
Values ValuesOf(const estimation::Result& fit);

struct LinearizedRun {
  LinearRun at;
  std::vector<int> columns;  // of the unknowns, one for each of J
  Eigen::MatrixXd J, J_J;
};

// What a run adds to the normal equations of unknowns (J) and of those coefficients of causes (C)
// that act in it: of a cause of many functions, such as one of time, they are few.
struct RunSums {
  std::vector<int> columns;       // of the unknowns
  std::vector<int> acting = {};   // the coefficients, of all in order
  Eigen::Index coefficients = 0;  // how many there are
  Eigen::MatrixXd J_J, C_J = {}, C_C = {};
};

std::vector<const RunSums*> PointersTo(const std::vector<RunSums>& sums);

class LinearRuns {
 public:
  // `campaign` says what machine they are made on. Blocks without values stay as the runs have
  // them.
  LinearRuns(const Campaign& campaign, std::vector<PreparedRun> runs, const Values& at);

  std::size_t count() const { return runs_.size(); }
  LinearizedRun At(std::size_t run) const;
  RunSums SumsOf(const LinearizedRun& run, const std::vector<Candidate>& candidates) const;
  // For sums with the same candidates.
  Eigen::MatrixXd Information(const std::vector<const RunSums*>& runs) const;

 private:
  std::vector<PreparedRun> runs_;
  estimation::Problem problem_;
  estimation::Layout layout_;
  Eigen::MatrixXd prior_;  // information
  std::vector<int> tied_;  // columns of prior_ that are not diagonal
};

}  // namespace abbe::diagnosis
