// The fits of the dwells of a sweep under one noise model: the mean gap of each group (station and
// direction), and the one jump of the zero that a probe may have.
//
// A jump at a time is one more unknown of its probe: all dwells from `first` on have it, and a dwell
// within which it falls is left free. With s the sum of V^-1 (y - mean) over the dwells after it and
// A the precision of its size (of the column of ones after it, the groups marginalised):
//
//   size = s / A,  chi2 falls by s^2 / A,  covariance of the means grows by m m' / A
//   log odds against none = s^2 / (A + 1 / b^2) / 2 - log(1 + b^2 A) / 2,  size ~ N(0, b^2)
//
// with m the means of that column and b = 1 um.
//
// Units: m, s. Shapes: white variances dwells x probes.
// Failure: as estimation/markov_noise.h.
// Source: Aitken's generalised least squares; Rasmussen and Williams, Gaussian Processes (2006),
// 2.7 for the odds.
// Validity: that of the noise model; the time of a jump is taken as known once it is found.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "probes/station_means.h"

namespace abbe::probes {

// The logarithms of white noise, drift and its time against what is stated.
using NoiseFactors = std::array<double, 3>;
struct ProbableNoise {
  NoiseFactors logs;
  double log_probability;
};

ProbeNoise Times(ProbeNoise noise, const NoiseFactors& logs);

// The factors for which `log_likelihood` and their prior (normal, each known to a factor of two)
// are most probable: one after the other is moved by ever smaller steps.
ProbableNoise MostProbableNoise(
    const std::function<double(const NoiseFactors& logs)>& log_likelihood);

class DwellFit {
 public:
  struct Jump {
    Eigen::Index first;                // dwell
    std::optional<Eigen::Index> free;  // the dwell within which it falls
    double size;                       // m, roughly
  };
  struct Sums {
    double chi2 = 0.0, log_likelihood = 0.0;
  };

  explicit DwellFit(const StationMeans& means);

  const std::vector<int>& groups() const { return groups_; }
  int group_count() const { return group_count_; }
  double dof() const;

  // Fits all probes; fills gap, covariance and jumps of `means`.
  Sums Run(const Eigen::MatrixXd& white, const ProbeNoise& noise, StationMeans& means) const;

  // Looks for a jump of each probe under the noise that suits all of them. It is taken where it
  // makes the dwells a thousand times as probable, all times of a jump together, as that noise and
  // as the noise that suits this probe best without it. One at a turn of the sweep is not: halves
  // of passes that scatter look the same. Returns whether there is any.
  bool FindJumps(const Eigen::MatrixXd& white, const ProbeNoise& noise,
                 const NoiseFactors& suiting);
  // Takes the jumps out of the gaps of the dwells, at the sizes in `means`.
  void TakeJumpsOut(StationMeans& means) const;

 private:
  struct OfProbe {
    Eigen::VectorXd gap;
    Eigen::MatrixXd covariance;
    Sums sums;
    double size = 0.0, u = 0.0;  // of the jump
  };

  OfProbe Fit(Eigen::Index probe, Eigen::VectorXd white, const ProbeNoise& noise,
              const std::optional<Jump>& jump) const;
  ProbableNoise NoiseOf(Eigen::Index probe, const Eigen::VectorXd& white, const ProbeNoise& noise,
                        const std::optional<Jump>& jump) const;
  bool AtTurn(const Jump& jump) const;

  struct Likeliest {
    Jump jump;
    double log_odds;
  };
  Likeliest LikeliestJump(Eigen::Index probe, const Eigen::VectorXd& white,
                          const ProbeNoise& noise) const;

  std::vector<double> times_;
  std::vector<int> groups_;
  std::vector<std::pair<int, int>> halves_;  // of each dwell: pass, direction
  Eigen::MatrixXd values_;
  int group_count_ = 0;
  PerProbe<std::optional<Jump>> jumps_;
};

}  // namespace abbe::probes
