// A run of the linkage of any length, part by part: what the fit of a million rows reads.
//
//   const LinkageParts parts = PartsOf(blocks, linkage);      // blocks of a recording
//   parts([&](const LinkageRun& part) { poses += part.poses(); });     // as often as wanted
//   const LinkageRun sample = SampleOf(parts, 4096, 1024).run;
//
// The parts follow each other in the order of the rows; the means of the stays are taken, as by
// MeansOfStays, also of those that begin in one block and end in the next. A stay of more rows than
// a block is cut.
// Units: those of LinkageRun. Shapes: as LinkageRun, part by part.
// Failure: as ReadLinkageRun; InputError when no row is without a flag.
// Memory: that of a block.
// Source: docs/theory-fusion.md, Long runs.
// Validity: a stay that is cut counts as two poses, of fewer samples each.
#pragma once

#include <Eigen/Core>
#include <functional>

#include "recording/blocks.h"
#include "relm/linkage_settings.h"
#include "simulation/linkage/linkage_run.h"

namespace abbe::simulation {

using LinkageParts = std::function<void(const std::function<void(const LinkageRun& part)>& use)>;

// Reads nothing yet.
LinkageParts PartsOf(recording::Blocks blocks, relm::LinkageSettings settings);

// All poses, or of more than `most` a sample of `count` drawn by the numbers of their rows: always
// the same, and without a rhythm that a path could meet. `poses`: of all parts.
struct LinkageSample {
  LinkageRun run;
  Eigen::Index poses;
};
// Reads all parts once.
LinkageSample SampleOf(const LinkageParts& parts, Eigen::Index most, Eigen::Index count);

}  // namespace abbe::simulation
