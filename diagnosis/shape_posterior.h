// The uncertainty of a cause with a shape that the data hardly know.
//
//   const ShapePosterior shapes(without, score);       // where IsHardlyKnown(score)
//   score = shapes.Widened();
//   other.covariance += shapes.Added()[of_other];      // of each cause beside it
//
// Amplitude and time constant of a drift that is hardly bent are known together only, far from a
// normal distribution about what was found. Here all plausible shapes, evenly in the logarithm, are
// weighed by their likelihoods, each with the coefficients that fit it best whatever is usual of
// them; in the covariance two standard deviations about what was found, of the shape as a share of
// it, then hold 95 % of this mixture. With each shape the coefficients of the causes beside it move:
// a delay of a clock with the feed at which a ball trails. Source: ISO/IEC Guide 98-3:2008/Suppl 1, 7.6 (a distribution
// instead of first order). Units: as in the score. Validity: the cause is linear in its
// coefficients, all else to first order.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "diagnosis/candidate.h"
#include "diagnosis/fit.h"

namespace abbe::diagnosis {

// Whether the logarithm of its free shape is known to less than a tenth.
bool IsHardlyKnown(const Score& score);

class ShapePosterior {
 public:
  // `without`: a fit with everything else that was found, which has to live as long. `score`: of the
  // fit with the cause.
  ShapePosterior(const Fit& without, Score score);

  Score Widened() const;
  // What the mixture adds to the covariance of each cause that `without` took in; empty for one
  // without columns.
  std::vector<Eigen::MatrixXd> Added() const;

 private:
  const Fit& without_;
  Score score_;
  std::vector<Score> all_;
  Eigen::VectorXd weights_;
};

}  // namespace abbe::diagnosis
