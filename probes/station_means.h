// The mean gaps of the stations of a sweep, with their covariance, noise and what is wrong with it:
// what probes/sweep_stations.h makes of its dwells.
//
// Groups are numbered station * directions + k, k in the order of `directions`.
// Frames: none; gaps of the probes.
// Units: m, s. Shapes: gaps 5 x groups, one covariance of groups x groups for each probe.
// Failure: none.
// Source: probes/sweep_stations.h.
// Validity: the same.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "probes/head_settings.h"
#include "probes/sweep_dwells.h"

namespace abbe::probes {

struct ProbeFigures {
  double white;  // m, standard deviation of one reading
  double lag1;   // correlation of neighbouring readings
  double drift;  // m, standard deviation of the dwells about their group, white noise subtracted
};

struct NoiseFigures {
  PerProbe<ProbeFigures> probes;
  double chi2 = 0.0;   // of the scatter between passes under the noise model, all probes
  double dof = 0.0;    // its degrees of freedom; 0 with one pass
  double scale = 1.0;  // sqrt(chi2 / dof) where that is significant
  double u_dof = 0.0;  // degrees of freedom of the noise's standard uncertainty
};

// The zero of one probe moved (dwell_fit.h).
struct ZeroMove {
  std::size_t probe;
  std::size_t dwell;  // the first after it
  double size, u;     // m
  double settles;     // s: the time constant of a warming up; 0: a jump between two dwells
};

// A dwell that disagrees with the other passes as no noise does (dwell_fit.h).
struct WildDwell {
  std::size_t probe, dwell;
  double off;     // m, read less what the others say
  bool or_other;  // of two passes: this one or the other
};

struct StationMeans {
  std::vector<int> directions;                         // {+1, -1}, or the only one
  std::vector<double> stations;                        // m, ascending
  Eigen::VectorXd position;                            // m, per group
  Eigen::Matrix<double, kProbes, Eigen::Dynamic> gap;  // m, per group
  PerProbe<Eigen::MatrixXd> covariance;                // m^2, group x group, per probe
  std::vector<Dwell> dwells;                           // those of `stations`
  Eigen::Matrix<double, kProbes, Eigen::Dynamic>
      residual;                 // m, per dwell: dwell - mean of its group
  std::vector<ZeroMove> moves;  // more unknowns; they are no longer in dwells and residual
  std::vector<WildDwell> wild;  // hardly counted, and no longer in dwells and residual
  Eigen::MatrixXd white;        // m^2, dwells x probes: variance of a dwell without its drift
  NoiseFigures noise;
  std::vector<std::string> notes;  // for the user, one sentence each

  Eigen::Index groups() const { return position.size(); }
};

}  // namespace abbe::probes
