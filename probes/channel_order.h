// Which probe each channel shows, where the cables of two probes were exchanged on purpose.
//
//   const ChannelOrder order = ChannelOrderOf(recording);
//   const recording::Recording shown = InProbeOrder(recording, order);
//
// Header `mounting.swapped = "probe_d+probe_e"`: at the amplifier, so that the column probe_d_um
// shows the gap of probe_e and the other way round. `InProbeOrder` gives each column the name of
// the probe that it shows; the header stays as it was. Gain, linearity, sign, drift and noise stay
// with the channel, everything else goes with the probe.
// Failure: InputError for a header that does not name two different probes.
#pragma once

#include "probes/head_layout.h"
#include "probes/head_settings.h"
#include "recording/recording.h"

namespace abbe::probes {

// The probe of each channel, and likewise the channel of each probe.
using ChannelOrder = PerProbe<std::size_t>;
inline constexpr ChannelOrder kAsNamed{0, 1, 2, 3, 4};

ChannelOrder ChannelOrderOf(const recording::Recording& recording);

recording::Recording InProbeOrder(recording::Recording recording, const ChannelOrder& order);
// The noise of the channel that shows each probe.
ProbeNoise InProbeOrder(const ProbeNoise& noise, const ChannelOrder& order);

}  // namespace abbe::probes
