// The noise of each probe and encoder as the recordings themselves show it, where the machine
// stands.
//
//   UseMeasuredNoise(recordings, instruments);
//   const Campaign campaign(std::move(instruments));
//
// In a standstill (simulation/stays.h) the readings of a channel are white noise, noise with a
// memory, or a line in time (estimation/readings_at_rest.h); a line is no noise and is left to the
// causes. What the machine file states is believed to 5 %; where the recordings say otherwise with
// 4 standard uncertainties, `instruments` get what they say of that channel, and a note tells it.
// The means of a sweep's stations have their scatter from the sweep itself
// (simulation/sweep/sweep_run.h), so sweeps are not asked for that. A channel whose noise, in a
// sweep too, is beyond doubt more than kFarMore times what is stated is listed in
// `instruments.noisy`: something is wrong with it.
// Units: m, rad. Shapes: one noise a channel.
// Failure: that of simulation/stays.h.
// Source: estimation/readings_at_rest.h.
// Validity: noise that is there only in motion does not show.
#pragma once

#include <string>
#include <vector>

#include "estimation/readings_at_rest.h"
#include "recording/recording.h"
#include "simulation/instruments.h"

namespace abbe::diagnosis {

inline constexpr double kFarMore = 3.0;

// The noise of a column, SI; freedom 0 without a standstill or without the column.
estimation::RestNoise NoiseAtRest(const std::vector<recording::Recording>& recordings,
                                  const std::string& column);

// With a note for each kind of channel whose noise was replaced.
void UseMeasuredNoise(const std::vector<recording::Recording>& recordings,
                      simulation::Instruments& instruments);

}  // namespace abbe::diagnosis
