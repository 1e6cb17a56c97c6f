// The fits of the dwells of a sweep under one noise model: the mean gap of each group (station and
// direction), and the one move of the zero that a probe may have.
//
// A move is a jump, all dwells from `first` on have it and one within which it falls is left free;
// or a warming up from the start on, 1 - exp(-t / tau). Its columns C are those of its unknowns: its
// size, and log(tau) about the value found. With r = V^-1 (y - mean), s = C' r, A the precision of
// the unknowns (C' V^-1 C, the groups marginalised) and D that of their prior:
//
//   unknowns = A^-1 s,  chi2 falls by s' A^-1 s,  covariance of the means grows by M A^-1 M'
//   log odds against none = s' (A + D)^-1 s / 2 - log det(1 + D^-1 A) / 2
//
// with M the means of the columns; a size is about 1 um, tau known to a factor of two.
//
// A wild dwell is one that a chip or a shock has moved, against the same place in the other passes:
// its variance grows by the square of that. Of two passes nobody knows which one: both grow.
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
  struct Move {
    Eigen::Index first;                // dwell
    std::optional<Eigen::Index> free;  // the dwell within which it falls
    double size;                       // m, roughly
    double settles = 0.0;              // s: tau of a warming up; 0: a jump
    bool alone = false;                // no move: this dwell only
  };
  struct Sums {
    double chi2 = 0.0, log_likelihood = 0.0;
  };

  explicit DwellFit(const StationMeans& means);

  const std::vector<int>& groups() const { return groups_; }
  int group_count() const { return group_count_; }
  double dof() const;

  // Fits all probes; fills gap, covariance and moves of `means`.
  Sums Run(const Eigen::MatrixXd& white, const ProbeNoise& noise, StationMeans& means) const;

  // Looks for a move of each probe under the noise that suits all of them. It is taken where it
  // makes the dwells a thousand times as probable, all times of a jump together, as the noise that
  // suits this probe best without it; a jump also under the noise of all. A jump at a turn of the sweep is not: halves
  // of passes that scatter look the same. Returns whether there is any.
  bool FindMoves(const Eigen::MatrixXd& white, const ProbeNoise& noise,
                 const NoiseFactors& suiting);
  // Looks for wild dwells of each probe, one after the other, at most one in twenty, each taken as a
  // move is, against the noise that suits this probe best without it. Returns whether there is any.
  bool FindWild(const Eigen::MatrixXd& white, const ProbeNoise& noise);
  // Takes the moves out of the gaps of the dwells, at the sizes in `means`, and gives wild dwells the
  // mean of their group; fills what is wild in `means`.
  void TakeMovesOut(StationMeans& means) const;

 private:
  struct OfProbe {
    Eigen::VectorXd gap;
    Eigen::MatrixXd covariance;
    Sums sums;
    Eigen::VectorXd unknowns = {}, u = {};  // of the move
  };

  // The variances of a probe with those of its wild dwells.
  Eigen::VectorXd WithWild(Eigen::Index probe, Eigen::VectorXd white) const;
  // The columns of the unknowns of a move.
  Eigen::MatrixXd ColumnsOf(const Move& move) const;
  OfProbe Fit(Eigen::Index probe, Eigen::VectorXd white, const ProbeNoise& noise,
              const std::optional<Move>& move) const;
  ProbableNoise NoiseOf(Eigen::Index probe, const Eigen::VectorXd& white, const ProbeNoise& noise,
                        const std::optional<Move>& move) const;
  bool AtTurn(const Move& jump) const;

  struct Likeliest {
    Move move;
    double log_odds;
  };
  // `moves`: with sizes of 1.
  Likeliest LikeliestOf(const std::vector<Move>& moves, Eigen::Index probe,
                        const Eigen::VectorXd& white, const ProbeNoise& noise) const;
  // The same move where the dwells have it: size and tau, or the dwell within which it falls.
  Move Refined(Move move, Eigen::Index probe, const Eigen::VectorXd& white,
               const ProbeNoise& noise) const;
  std::vector<Move> Jumps() const;
  std::vector<Move> WarmingsUp() const;
  std::vector<Move> Alone() const;  // each dwell that others can be held against
  std::vector<Move> Candidates(Eigen::Index probe, const Eigen::VectorXd& white,
                               const ProbeNoise& noise, const NoiseFactors& suiting,
                               double enough) const;
  double Whole() const;    // s, from the first dwell to the last
  double Between() const;  // s, from one to the next

  std::vector<double> times_;
  std::vector<int> groups_;
  std::vector<std::pair<int, int>> halves_;  // of each dwell: pass, direction
  Eigen::MatrixXd values_;
  int group_count_ = 0;
  PerProbe<std::optional<Move>> moves_;
  Eigen::MatrixXd wild_;  // m^2, dwells x probes: more variance
  std::vector<WildDwell> wild_dwells_;
};

}  // namespace abbe::probes
