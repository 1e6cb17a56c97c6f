// What the reduction of one sweep found.
//
// Errors are actual - nominal in the symbols of ISO 230-1, in the machine frame. Gauge: an angle is
// zero at the first station, a straightness is the deviation from its least-squares line over the
// stations. u is a standard uncertainty that holds the whole budget; U95 = coverage * u.
// Units: m, rad, s. Shapes: one value per station unless said otherwise; lists per dwell are in the
// order of time.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "probes/sweep_conditions.h"
#include "probes/sweep_dwells.h"
#include "probes/sweep_inversion.h"
#include "probes/sweep_stations.h"
#include "probes/sweep_uncertainty.h"
#include "standards/reference_line.h"

namespace abbe::probes {

struct Uncertain {
  double value = 0.0;
  double u = 0.0;
};

// forward - backward (ISO: up - down). Where there is none at all, one of the fifteen means of
// three axes is `seen` in 1 % of all machines (Bonferroni), as far as the noise model holds.
struct Reversal {
  Eigen::VectorXd value, u;
  Uncertain mean;
  Uncertain largest;  // by magnitude, with its sign
  bool seen;          // the mean is beyond chance
};

// A reference line through ComponentResult::value over the stations, and the error about it.
struct LineFigure {
  standards::Line line;  // offset at position 0 of the machine
  double error;          // m: largest positive + |largest negative| deviation
};

struct StraightnessFigures {
  LineFigure end_points, least_squares, minimum_zone;
  double u;         // m, of the error about the least-squares line
  Uncertain slope;  // rad: of the least-squares line over the positions, which the gauge took off
};

struct ComponentResult {
  Component component;
  Eigen::VectorXd value, u;           // at the axis reference, mean of the directions
  Eigen::VectorXd forward, backward;  // the same, by direction; empty when not measured
  Eigen::VectorXd at_target, u_at_target;
  std::optional<Reversal> reversal;  // both directions measured
  std::optional<Uncertain> range;    // of an angle: largest - smallest
  std::optional<StraightnessFigures> straightness;
  std::array<double, kSources>
      budget;       // rms over the stations of the standard uncertainty by source
  double coverage;  // of U95: Student's t at the effective degrees of freedom
};

struct SweepResult {
  std::string recording, machine, chain;
  char axis = 'X';
  MovingBody moving = MovingBody::kTarget;
  double sense = 1.0;    // of the axis: CarriageSense, machine/chain.h
  std::string positive;  // "tool" or "carriage": how its control counts
  std::string mounting;  // as the header says it; empty when it does not
  SweepConditions conditions;
  std::vector<double> stations;  // m, ascending
  int passes = 0;
  SampleCounts counts;
  std::array<ComponentResult, kComponents> components;  // EA. EB. EC., then the two straightnesses
  std::vector<Dwell> dwells;
  GroupReadings residual;  // per dwell: dwell - mean of its station and direction
  NoiseFigures noise;
  std::vector<std::string> notes;  // what the user must know, one sentence each
};

}  // namespace abbe::probes
