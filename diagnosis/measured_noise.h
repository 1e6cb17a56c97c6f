// The noise of probes and encoders as the recordings themselves show it, where the machine stands.
//
//   UseMeasuredNoise(recordings, instruments);
//   const Campaign campaign(std::move(instruments));
//
// A standstill is a sequence of good rows in which no axis moves by more than a scale trembles. In
// it, half of the mean square of the differences of neighbouring readings is the variance of the
// white noise of a channel; drift hardly enters. Of all channels of one kind the median counts, so
// that one that picks something up does not make the others worse. What the machine file states is
// believed to 5 %; where the recordings say otherwise with 4 standard uncertainties, `instruments`
// get what they say, and a note tells it. The means of a sweep's stations have their scatter from
// the sweep itself (simulation/sweep/sweep_run.h), so sweeps are not asked.
// Units: m, rad. Source: J. von Neumann et al., The mean square successive difference, Ann. Math.
// Statist. 12 (1941); degrees of freedom (2/3) of the differences for many readings.
#pragma once

#include <string>
#include <vector>

#include "recording/recording.h"
#include "simulation/instruments.h"

namespace abbe::diagnosis {

// Standard deviation of one reading of a channel, while nothing moves.
struct StillNoise {
  double sd = 0.0;
  double freedom = 0.0;
};
// The noise of a column, SI; freedom 0 without a standstill or without the column.
StillNoise NoiseAtRest(const std::vector<recording::Recording>& recordings,
                       const std::string& column);

// With a note for each kind of channel whose noise was replaced.
void UseMeasuredNoise(const std::vector<recording::Recording>& recordings,
                      simulation::Instruments& instruments);

}  // namespace abbe::diagnosis
