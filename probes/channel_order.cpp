#include "probes/channel_order.h"

#include <fmt/format.h>

#include <string>
#include <utility>

#include "failure/failure.h"

namespace abbe::probes {
namespace {

constexpr const char* kKey = "mounting.swapped";

std::string NameOf(std::size_t probe) {
  return fmt::format("probe_{}", static_cast<char>('a' + probe));
}

}  // namespace

ChannelOrder ChannelOrderOf(const recording::Recording& recording) {
  ChannelOrder order = kAsNamed;
  const auto text = recording.HeaderText(kKey);
  if (!text) return order;
  for (std::size_t one = 0; one < kProbes; ++one) {
    for (std::size_t other = 0; other < kProbes; ++other) {
      if (one == other || *text != NameOf(one) + "+" + NameOf(other)) continue;
      std::swap(order[one], order[other]);
      return order;
    }
  }
  throw InputError(fmt::format(
      "{}: {} is \"{}\"; name the two probes whose cables were exchanged, as \"probe_d+probe_e\"",
      recording.name, kKey, *text));
}

recording::Recording InProbeOrder(recording::Recording recording, const ChannelOrder& order) {
  if (order == kAsNamed) return recording;
  for (auto& column : recording.columns) {
    for (std::size_t channel = 0; channel < kProbes; ++channel) {
      if (column.name != NameOf(channel) + "_um") continue;
      column.name = NameOf(order[channel]) + "_um";
      break;
    }
  }
  return recording;
}

ProbeNoise InProbeOrder(const ProbeNoise& noise, const ChannelOrder& order) {
  ProbeNoise ordered = noise;
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    ordered.measured[probe] = noise.measured[order[probe]];
    ordered.memory[probe] = noise.memory[order[probe]];
    ordered.memory_time[probe] = noise.memory_time[order[probe]];
  }
  return ordered;
}

}  // namespace abbe::probes
