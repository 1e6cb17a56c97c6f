// The covariance of the five errors of a sweep, by source: GUM first order.
//
//   noise         covariance of the station means, through the linearised inversion
//   gain          of each probe, relative (head.tolerance.gain)
//   linearity     of each probe over its gaps (probes/probe_linearity.h)
//   position      of each probe in the fixture (head.tolerance.probe_position)
//   installation  of the head: three angles, three offsets (head.tolerance)
//   form          of the target: a Gaussian process over each face with standard deviation
//                 target.form and correlation exp(-(distance / form_length)^2 / 2), larger by
//                 UncheckedTimes(target.form_known_to)
//
// A reading contains the form at the point where its measuring line meets the face: at u - d where
// the target moves, at u + d where the head moves. Probes that follow each other along one line
// therefore read the same form one after the other.
//
// The inversion is exactly determined (five readings, five errors), so the data cannot separate a
// source from the errors and every source enters with its stated uncertainty. The sources other
// than noise, linearity and form are normal with the standard deviations of the machine file; their columns
// are central differences of the exact inversion over +-1 standard deviation. The tests check the
// sum against a Monte Carlo through the exact inversion (GUM Supplement 1).
//
// Frames: M, as GroupErrors.
// Units: rad^2 for an angle, m^2 for a straightness. Shapes: groups x groups.
// Failure: InputError as sweep_inversion.h.
// Source: GUM (2008) 5.2; docs/sweep.md lists the sources of the budget.
// Validity: second order in the tolerances is neglected, 1e-3 of each column at 500 urad and 10 um.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string_view>
#include <vector>

#include "probes/head_settings.h"
#include "probes/station_means.h"
#include "probes/sweep_gauge.h"
#include "probes/sweep_inversion.h"

namespace abbe::probes {

inline constexpr std::size_t kSources = 6;
inline constexpr std::array<std::string_view, kSources> kSourceNames = {
    "noise", "gain", "linearity", "position", "installation", "form"};

// A size that nothing checks is lognormal about what is stated, with the logarithm of `known_to` as
// standard deviation: its root mean square over what is stated. 1 for a size that is known, 1.62
// for one that is known to a factor of two. In multiples of that rms, U95 is 2.03, near 1.96.
double UncheckedTimes(double known_to);

class SweepUncertainty {
 public:
  SweepUncertainty(const machine::Machine& machine, const HeadSettings& head,
                   const TargetSettings& target, char axis, const Eigen::Vector3d& start,
                   const StationMeans& means);

  // The covariance by source of one row of GroupErrors, before any gauge.
  std::array<Eigen::MatrixXd, kSources> Covariance(Eigen::Index row) const;
  // What a linearity of kUsualLinearity would add.
  Eigen::MatrixXd UsualLinearity(Eigen::Index row) const;

 private:
  using Columns = std::vector<GroupErrors>;  // one per parameter, times its standard deviation

  // The covariance of Delta of two probes by the form of the face that both read.
  struct FormOfPair {
    std::size_t p, q;
    Eigen::MatrixXd V;
  };

  void AddForm();
  // By independent covariances of the gaps of each probe.
  Eigen::MatrixXd ProbeCovariance(Eigen::Index row, PerProbe<Eigen::MatrixXd> of_gaps) const;
  PerProbe<Eigen::MatrixXd> Departures(const PerProbe<>& linearity) const;
  Eigen::MatrixXd FormCovariance(Eigen::Index row) const;
  Eigen::MatrixXd ColumnCovariance(const Columns& columns, Eigen::Index row) const;
  // Turns the covariance V of the gaps of two probes into that of their Delta: subtracts the mean
  // of the first station where that is the zero.
  void TakeZero(std::size_t row_probe, std::size_t column_probe, Eigen::MatrixXd& V) const;
  Eigen::VectorXd Sensitivity(Eigen::Index row, std::size_t probe) const;

  HeadSettings head_;
  TargetSettings target_;
  const StationMeans& means_;
  Eigen::Index first_;  // groups of the first station
  MovingBody moving_;
  Eigen::VectorXd travel_;  // m, per group
  std::vector<GroupJacobian> jacobians_;
  Columns gain_, position_, installation_;
  std::vector<FormOfPair> form_;
};

}  // namespace abbe::probes
