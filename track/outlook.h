// How long a tracked map stays good enough, and which short test keeps it so.
//
//   const std::vector<Watched> watched = Watch(tracked, limits);
//   watched[0].U95, watched[0].exceeded;                      // now; when it exceeds the limit
//   const Choice choice = NextTest(tracked, candidates, limits, horizon);
//
// A limit of an error is compared with the largest U95 of that error over the travel, a limit of
// the volumetric error with the largest over a grid of the volume: beyond it, the map says neither
// pass nor fail. Limits of what no map states (circularity, positioning A) are left out. Time alone
// widens U95: temperatures stay as they are. Candidates are tests that were made before, with their
// durations; of all choices of up to three of them the one that takes the fewest minutes and keeps
// every U95 below its limit for `horizon`.
// Units: those of the limits (um, urad) for U95, s since 1970, min. Shapes: one entry a limit.
// Failure: none. A choice that keeps no limit says so.
// Source: variances of a random walk are linear in time.
// Validity: that of TrackedMap; a test is as good as it was the last time.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "history/limits.h"
#include "track/tracked_map.h"

namespace abbe::track {

struct Watched {
  std::string name;  // "EYX.straightness_um", "volumetric_um"
  double limit = 0.0, U95 = 0.0;
  std::optional<double> exceeded = {};  // when; none: not within ten years
};

std::vector<Watched> Watch(const TrackedMap& tracked, const history::Limits& limits);

struct Candidate {
  std::string name;
  double minutes = 0.0;
  LinearTest test;
};

struct Choice {
  bool enough = false;
  std::vector<std::string> tests;  // none, and enough: nothing is needed
  double minutes = 0.0;
  std::vector<Watched> after;  // U95 at the end of the horizon with these tests made now
};

// `tracked` knows the parameters of all candidates. `horizon`: s from its time on.
Choice NextTest(const TrackedMap& tracked, std::vector<Candidate> candidates,
                const history::Limits& limits, double horizon);

}  // namespace abbe::track
