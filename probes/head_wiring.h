// Whether the five channels are wired as the machine file says: two that are swapped, a sign that
// is wrong, a channel that does not follow the target.
//
//   const WiringFinding found = FindWiring(readings, turned, aligner);
//   if (!found.wrong.empty()) fmt::print("{}\n", NameOf(found.wrong.front()));
//
// Method. Each wiring is a normal distribution of all readings together; the finding is the one
// with the highest likelihood. What is not known has a wide variance: the gap of each probe at the
// start, the tilts of both faces (10 mrad). What is known within limits: each prescribed turn of a
// screw (10 % and 10 degrees), the error motions of the axis (`AlignSettings::motion`, 50 urad),
// the gains (1 %). A wrong wiring is named when it is e^8 times likelier than the right one; with
// it go those that are less than e^3 times less likely than it.
//
// The travel alone shows what breaks the common slope of a face: a wrong sign, or a top probe in
// the place of a side probe, where the faces are tilted. Turned screws show all of it. `TestTurn`
// gives the turn that separates what is left.
//
// Units: m. Shapes: readings of five probes at any number of places.
// Failure: none. Source: the project's; Gaussian likelihoods.
// Validity: one fault at a time.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "probes/head_alignment.h"

namespace abbe::probes {

struct Wiring {
  enum class Kind : unsigned char {
    kRight,
    kSwapped,   // `probes` are the two
    kInverted,  // the gap grows in the channel where it shrinks: one probe, or all of a face or head
    kUnmoved,   // the channel shows something else than the gap
  };
  Kind kind = Kind::kRight;
  std::vector<std::size_t> probes;  // 0 to 4 for a to e

  bool operator==(const Wiring&) const = default;
};

// "probe_b and probe_c are swapped"
std::string NameOf(const Wiring& wiring);

struct WiringFinding {
  std::vector<Wiring> wrong;  // empty: as it should be; several: one of them, the likeliest first
  std::vector<Wiring>
      open;  // nothing is wrong, but these are not excluded: e^3 less likely or more
};

// `turned[k]`: the turns between the settings k and k + 1.
WiringFinding FindWiring(std::span<const GapsAt> readings,
                         std::span<const std::vector<ScrewTurn>> turned,
                         const HeadAligner& aligner);

// The turn of one screw that moves the probes of `rivals` the most, by at most a tenth of a range
// and towards the middle of it, as they stand in `at`. Nothing without screws.
std::optional<ScrewTurn> TestTurn(std::span<const Wiring> rivals, const GapsAt& at,
                                  const HeadAligner& aligner);

}  // namespace abbe::probes
