// The result of the reduction of one sweep.
//
// Errors are actual - nominal in the symbols of ISO 230-1, in the machine frame. Gauge: an angle is
// zero at the first station, a straightness is the deviation from its least-squares line over the
// stations. u is the combined standard uncertainty of all sources; U95 = coverage * u.
// Frames: M.
// Units: m, rad, s. Shapes: one value per station unless said otherwise; lists per dwell are in the
// order of time.
// Failure: none; ReduceSweep makes it.
// Source: figures of straightness: ISO 230-1 (standards/reference_line.h); reversal: ISO 230-2.
// Validity: U95 assumes errors that are near normal; its coverage is Student's t.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "probes/planned_sweep.h"
#include "probes/station_means.h"
#include "probes/sweep_conditions.h"
#include "probes/sweep_dwells.h"
#include "probes/sweep_inversion.h"
#include "probes/sweep_uncertainty.h"
#include "standards/reference_line.h"

namespace abbe::probes {

struct Uncertain {
  double value = 0.0;
  double u = 0.0;
};

// The reversal error, forward - backward (ISO: up - down). On a machine without any, the
// probability that one or more of the fifteen means of three axes are `seen` is 1 % (Bonferroni),
// if the noise model holds.
struct Reversal {
  Eigen::VectorXd value, u;
  Uncertain mean;
  Uncertain largest;  // by magnitude, with its sign
  bool seen;          // the mean is significant
};

// A reference line through ComponentResult::value over the stations, and the error about it.
struct LineFigure {
  standards::Line line;  // offset at position 0 of the machine
  double error;          // m: largest positive + |largest negative| deviation
};

struct StraightnessFigures {
  LineFigure end_points, least_squares, minimum_zone;
  double u;         // m, of the error about the least-squares line
  Uncertain slope;  // rad: of the least-squares line over the positions, removed by the gauge
};

struct ComponentResult {
  Component component;
  Eigen::VectorXd value, u;           // at the axis reference, mean of the directions
  Eigen::VectorXd forward, backward;  // the same, by direction; empty when not measured
  Eigen::VectorXd at_target, u_at_target;
  std::optional<Reversal> reversal;  // both directions measured
  std::optional<Uncertain> range;    // of an angle: largest - smallest
  std::optional<StraightnessFigures> straightness;
  std::array<double, kSources> budget;  // standard uncertainty by source, rms over the stations
  double coverage;                      // of U95: Student's t at the effective degrees of freedom
};

struct SweepResult {
  std::string recording, machine, chain;
  char axis = 'X';
  MovingBody moving = MovingBody::kTarget;
  double sense = 1.0;    // of the axis: CarriageSense, machine/chain.h
  std::string positive;  // "tool" or "carriage": how its control counts
  std::string mounting;  // as stated in the header, else empty
  SweepConditions conditions;
  std::vector<double> stations;  // m, ascending
  int passes = 0;
  std::optional<PlannedSweep> planned;  // as the header says
  SampleCounts counts;
  std::array<ComponentResult, kComponents> components;  // EA. EB. EC., then the two straightnesses
  std::vector<Dwell> dwells;
  GroupReadings residual;  // per dwell: dwell - mean of its station and direction
  NoiseFigures noise;
  std::vector<std::string> notes;  // for the user, one sentence each
};

}  // namespace abbe::probes
