// The gain of an extended simulation on data that it did not see.
//
//   const HeldOutGain gain = HoldOut(campaign, recordings, causes);
//   gain.after / gain.before;
//
// Which rows are held out the kind of a run says (simulation/run_kind.h): every other pass, where
// there are several; every other of 8 blocks in time, so that neighbouring rows stay together;
// every fourth pose of an arm; every other run of the linkage on one base, where there are three. A
// sweep with one pass and runs of other kinds take no part. The simulation is fitted to the rest,
// once as it is, once with the causes and once with all but each of them, and asked for the rows
// that were held out: rms of (measured - simulated) / stated deviation, 1 for the noise floor.
// Units: standard deviations; m where said. Shapes: one Without a cause, in their order.
// Failure: that of Fit.
// Source: docs/theory-diagnosis.md.
// Validity: says whether a cause predicts, not whether it is the right one of two that do the same.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "diagnosis/campaign.h"
#include "diagnosis/candidate.h"
#include "recording/recording.h"

namespace abbe::diagnosis {

struct HeldOutGain {
  Eigen::Index rows = 0;  // held out; 0: the runs have no passes to hold out
  double before = 0.0, after = 0.0;
  Eigen::Index arm_poses = 0;
  double arm_before = 0.0, arm_after = 0.0;  // m, rms in space, of the poses of arms

  // What each cause is worth beside all others: rms of the rows that the fits saw, and of those
  // held out, without it. NaN where nothing can be fitted without it.
  struct Without {
    double seen, held;
  };
  std::vector<Without> without = {};  // in the order of the causes
  double seen = 0.0;                  // with all of them
};

// `recordings`: those of the campaign.
HeldOutGain HoldOut(const Campaign& campaign, const std::vector<recording::Recording>& recordings,
                    const std::vector<Candidate>& causes);

// The same where it is worth it (causes, or noise that the runs estimate) and half of the runs
// suffice for a fit; else no rows, and `why_not` says why they do not suffice.
HeldOutGain HoldOutWhereTheySuffice(const Campaign& campaign,
                                    const std::vector<recording::Recording>& recordings,
                                    const std::vector<Candidate>& causes, std::string& why_not);

}  // namespace abbe::diagnosis
