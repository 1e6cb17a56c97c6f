// What the data say of structures (structure.h) beside a fit.
//
//   StructureQuestions questions(fit);
//   const std::vector<Found> found = questions.Ask({SmoothIn(channel, "x", range)});
//   found.front().log_probability;                      // below log(1e-3): it is there
//
// A structure explains what its terms take out of what is left of its channel, free of everything
// that the simulation could be instead (fit.h): chi-square distributed where nothing is there. The
// strongest line or interval counts as one of so many.
// Units: SI. Shapes: one row of a projection for each term of a structure. Validity: to first
// order at the fit. Source: score test, Rao (1948).
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <mutex>
#include <string>
#include <tuple>
#include <vector>

#include "diagnosis/evidence.h"
#include "diagnosis/fit.h"
#include "diagnosis/structure.h"
#include "diagnosis/unexplained.h"

namespace abbe::diagnosis {

struct Found {
  Structure structure;
  double chi_square = 0.0;
  int freedom = 0;
  double length = 0.0;           // of the coefficients, m or rad
  double log_probability = 0.0;  // of as much by chance, the strongest of so many
  // The coefficients as draws: their deviation, and the evidence against nothing, among so many.
  DrawnSize drawn{0.0, 0.0};
  // Other variables (and channels) with which the data go as well, within kAsGood.
  std::vector<Dependence> one_of = {};
};

Found Explained(Structure structure, const Fit::Projection& projection);

// Functions of the rows are made once for all channels that are asked of them. Safe to share
// between threads.
class StructureQuestions {
 public:
  explicit StructureQuestions(const Fit& fit) : fit_(fit) {}

  // `structures`: at least one, all of one channel, since they share its stage.
  std::vector<Found> Ask(const std::vector<Structure>& structures);

 private:
  using Key = std::tuple<std::size_t, std::string, double, double, double, double, Eigen::Index,
                         Eigen::Index, bool>;

  const Eigen::MatrixXd& SharedFunctions(std::size_t run, const Structure& structure);
  const Eigen::MatrixXd* Known(const Key& key);

  const Fit& fit_;
  std::mutex mutex_;
  std::map<Key, Eigen::MatrixXd> known_;  // one row for each term
};

// What the data say of one.
Found Asked(const Fit& fit, const Structure& structure);

}  // namespace abbe::diagnosis
