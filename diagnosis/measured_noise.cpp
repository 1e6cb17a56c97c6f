#include "diagnosis/measured_noise.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "simulation/kinds.h"
#include "simulation/stays.h"

namespace abbe::diagnosis {
namespace {

using estimation::RestKind;
using estimation::RestNoise;
using recording::Recording;

constexpr double kBelieved = 0.05, kDoubtSds = 4.0;

// A recording and where it stands.
struct Standstill {
  const Recording& recording;
  simulation::Stays stays;
  bool shows_noise;
};

std::vector<Standstill> StandstillsOf(const std::vector<Recording>& recordings) {
  std::vector<Standstill> all;
  all.reserve(recordings.size());
  for (const Recording& recording : recordings) {
    const simulation::RunKind& kind = simulation::KindOf(recording);
    all.push_back({recording, kind.StaysIn(recording), kind.ShowsNoiseAtRest()});
  }
  return all;
}

RestNoise NoiseOf(const std::vector<Standstill>& all, const std::string& column, bool shows_noise) {
  std::vector<estimation::Stay> stays;
  for (const Standstill& each : all) {
    if (each.shows_noise != shows_noise || !each.recording.Find(column)) continue;
    for (auto& stay : simulation::ReadingsIn(each.recording, column, each.stays)) {
      stays.push_back(std::move(stay));
    }
  }
  return estimation::NoiseAtRest(stays);
}

bool IsOther(const RestNoise& noise, double stated) {
  const double doubt = kDoubtSds / std::sqrt(2.0 * noise.freedom);
  return noise.freedom >= 1.0 && noise.sd > 0.0 &&
         std::abs(noise.sd / stated - 1.0) > std::max(kBelieved, doubt);
}

bool IsFarMore(const RestNoise& noise, double stated) {
  return noise.freedom >= 1.0 && noise.kind != RestKind::kLine &&
         noise.sd * (1.0 - kDoubtSds / std::sqrt(2.0 * noise.freedom)) > kFarMore * stated;
}

// Channels of one kind and what the machine file states of each.
struct ChannelKind {
  std::string name, unit;
  double scale, stated;
  std::vector<std::string> columns, channels;
};

// What counts of each channel; sd 0: what is stated.
std::vector<RestNoise> Measured(const std::vector<Standstill>& all, const ChannelKind& kind,
                                simulation::Instruments& instruments) {
  std::vector<RestNoise> found;
  std::string replaced;
  double least = 1e300;
  for (std::size_t i = 0; i < kind.columns.size(); ++i) {
    RestNoise rest = NoiseOf(all, kind.columns[i], true);
    const RestNoise in_sweeps = NoiseOf(all, kind.columns[i], false);
    for (const RestNoise& each : {rest, in_sweeps}) {
      if (!IsFarMore(each, kind.stated)) continue;
      instruments.noisy.push_back({kind.channels[i], each.sd / kind.stated, each.freedom});
      break;
    }
    if (rest.kind == RestKind::kMemory) {
      instruments.notes.push_back(fmt::format(
          "readings of {} go on from one to the next where nothing moves: {:.0f} % of their "
          "variance fades within {:.2g} s; evidence counts them as so many fewer",
          kind.channels[i], 100.0 * std::pow(rest.memory.slow / rest.memory.sd(), 2),
          rest.memory.time));
    }
    if (IsOther(rest, kind.stated)) {
      replaced += fmt::format("{}{} {:.3g} {}", replaced.empty() ? "" : ", ", kind.channels[i],
                              rest.sd / kind.scale, kind.unit);
      least = std::min(least, rest.freedom);
    } else {
      rest.sd = 0.0;
    }
    found.push_back(rest);
  }
  if (!replaced.empty()) {
    instruments.notes.push_back(fmt::format(
        "noise of the {}: {} where nothing moves ({:.0f} degrees of freedom or more), not {:.3g} "
        "{} as the machine file states; what was measured counts",
        kind.name, replaced, least, kind.stated / kind.scale, kind.unit));
  }
  return found;
}

void MeasureProbes(const std::vector<Standstill>& all, simulation::Instruments& on) {
  ChannelKind probes{"probes", "nm", 1e-9, on.noise.probe, {}, {}};
  for (const char letter : {'a', 'b', 'c', 'd', 'e'}) {
    probes.columns.push_back(fmt::format("probe_{}_um", letter));
    probes.channels.push_back(fmt::format("probe_{}", letter));
  }
  const std::vector<RestNoise> found = Measured(all, probes, on);
  for (std::size_t i = 0; i < found.size(); ++i) {
    on.noise.measured[i] = found[i].sd;
    if (found[i].kind != RestKind::kMemory) continue;
    const double all_of_it = found[i].sd > 0.0 ? found[i].sd : on.noise.probe;
    const double of_one = all_of_it / found[i].memory.sd();
    constexpr double kLeastShare = 1e-3;  // a covariance needs some white noise
    on.noise.measured[i] = std::max(of_one * found[i].memory.white, kLeastShare * all_of_it);
    on.noise.memory[i] = of_one * found[i].memory.slow;
    on.noise.memory_time[i] = found[i].memory.time;
  }
}

void MeasureEncoders(const std::vector<Standstill>& all, simulation::Instruments& on) {
  relm::LinkageNoise& noise = on.linkage->noise;
  ChannelKind encoders{"encoders", "urad", 1e-6, noise.encoder, {}, {}};
  for (int i = 1; i <= on.linkage->chain.joints(); ++i) {
    encoders.columns.push_back(fmt::format("pivot_{}_rad", i));
    encoders.channels.push_back(fmt::format("pivot_{}", i));
  }
  const std::vector<RestNoise> found = Measured(all, encoders, on);
  for (const RestNoise& each : found) {
    noise.measured.push_back(each.sd);
    if (each.kind != RestKind::kMemory) continue;
    // The longest counts for all.
    const double share = std::pow(each.memory.slow / each.memory.sd(), 2);
    if (share * each.memory.time <= noise.memory_share * noise.memory_time) continue;
    noise.memory_share = share;
    noise.memory_time = each.memory.time;
  }
}

}  // namespace

RestNoise NoiseAtRest(const std::vector<Recording>& recordings, const std::string& column) {
  return NoiseOf(StandstillsOf(recordings), column, true);
}

void UseMeasuredNoise(const std::vector<Recording>& recordings,
                      simulation::Instruments& instruments) {
  const std::vector<Standstill> all = StandstillsOf(recordings);
  if (instruments.head) MeasureProbes(all, instruments);
  if (instruments.linkage) MeasureEncoders(all, instruments);
}

}  // namespace abbe::diagnosis
