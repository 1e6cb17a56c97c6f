// The set-up of target and head: from the gaps at two or more places of the travel, the tilt of
// both faces against the axis, the gap of each probe over the whole travel, and the turns of the
// screws that bring all of it to the middle of the ranges.
//
//   const HeadAligner aligner(machine, head, settings, 'X', first, last);
//   const HeadAlignment found = aligner.Evaluate(readings);
//   for (const ScrewTurn& turn : found.turns) fmt::print("{} {:+.2f}\n", turn.screw, turn.turns);
//
// Method. Over the travel d a gap is a straight line; the probes of one face share its slope, the
// tilt of the face against the axis. The least-squares lines through the readings of one setting of
// the screws give the gaps at both ends of the travel, with the uncertainty that the error motions
// of the axis leave (`AlignSettings::motion` a reading). The turns minimise the sum of the squares
// of (gap - middle) / range over probes and ends, by the least motion that does (screw_motion.h).
//
// Frames: H of head_layout.h. Units: m, rad. A turn is positive clockwise. Shapes: five probes in
// the order A, B, C, D, E; as many turns as there are screws to be turned.
// Failure: InputError when the readings of the last setting are at fewer than two places.
// Source: the project's; the planes of the faces are those of head_model.h, to first order.
// Validity: tilts up to 10 mrad. Beyond the readings a line is extrapolated.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "machine/machine.h"
#include "probes/head_settings.h"
#include "probes/screw_motion.h"

namespace abbe::probes {

// The mean gaps at a place of the travel.
struct GapsAt {
  int setting = 0;      // of the screws: counts from 0, one more whenever they were turned
  double travel = 0.0;  // m
  PerProbe<> gap = {};  // m; NaN: no good reading
};

struct ScrewTurn {
  std::size_t screw;  // index into AlignSettings::screws
  double turns;       // clockwise; a multiple of kFinestTurn
};
inline constexpr double kFinestTurn = 0.01;

// The gap of a probe over the travel.
struct GapOutlook {
  double first = 0.0, last = 0.0;  // m, at the ends of the travel
  double u = 0.0;                  // m, the larger standard uncertainty of the two
  double range = 0.0;              // m

  double Low() const { return std::min(first, last) - 2.0 * u; }
  double High() const { return std::max(first, last) + 2.0 * u; }
  // What stays free of the range at its nearer end; negative: so much is missing.
  double Room() const { return std::min(Low(), range - High()); }
};

struct Tilt {
  double value = 0.0, u = 0.0;  // rad: the face rises along u
};

enum class AlignVerdict {
  kReady,         // the whole travel lies within the ranges less the margin, as it stands
  kTravelUnseen,  // predicted so from less than 4/5 of the travel
  kTurn,          // the turns bring it there
  kOutOfReach,    // the best turns leave `after` outside: move the probes in their holders
};

struct HeadAlignment {
  AlignVerdict verdict = AlignVerdict::kOutOfReach;
  double seen = 0.0;  // share of the travel between the outermost readings
  Tilt top, side;
  PerProbe<GapOutlook> now;
  std::vector<ScrewTurn> turns;  // to the middle of the ranges; empty where no screw is described
  PerProbe<GapOutlook> after;    // the turns
  SmallMotion motion;            // of the target, that the turns (or hands, without screws) make
};

// Half of these turns taken back: what brings gaps into range again that the turns took out of it,
// because a channel is wired wrongly.
std::vector<ScrewTurn> HalfBack(std::span<const ScrewTurn> turns);

class HeadAligner {
 public:
  // `first`, `last`: m, the ends of the sweep as the control counts.
  HeadAligner(const machine::Machine& machine, const HeadSettings& head,
              const AlignSettings& settings, char axis, double first, double last);

  // m along u since the start of the sweep, at a position of the axis.
  double TravelOf(double position) const { return sense_ * (position - first_); }
  const ScrewMotion& screws() const { return motion_; }
  const AlignSettings& settings() const { return settings_; }
  const PerProbe<>& ranges() const { return ranges_; }
  // m of each screw for these turns.
  Eigen::VectorXd ScrewedBy(std::span<const ScrewTurn> turns) const;

  // For the last setting among `readings`; places with a NaN are left out.
  HeadAlignment Evaluate(std::span<const GapsAt> readings) const;

 private:
  void Propose(HeadAlignment& found) const;
  bool Fits(const PerProbe<GapOutlook>& outlook) const;

  AlignSettings settings_;
  PerProbe<> ranges_;
  double sense_, first_;
  double end_;  // m, travel at the last station
  ScrewMotion motion_;
};

}  // namespace abbe::probes
