#include "probes/sweep_slips.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "failure/failure.h"
#include "machine/plausible_position.h"
#include "settings/unit.h"

namespace abbe::probes {
namespace {

using settings::kMicrometre;
using settings::kMillimetre;

constexpr double kStill = 1e-12;              // m: far below the step of any converter
constexpr double kNextToNothing = 1 / 500.0;  // of a probe's range
constexpr double kOtherUnit = 100.0;

std::string NameOfProbe(std::size_t probe) { return fmt::format("probe_{:c}", 'a' + probe); }

void RefuseFarPositions(const std::string& name, const SweepDwells& sweep,
                        const machine::Machine& machine) {
  for (const Dwell& dwell : sweep.dwells) {
    for (int axis = 0; axis < 3; ++axis) {
      const bool swept = axis == sweep.axis - 'X';
      const double position = swept ? dwell.position : dwell.axes[axis];
      const machine::Travel& travel = machine.travels[axis];
      const machine::Travel span = machine::PlausiblePositions(travel);
      if (position >= span.first && position <= span.last) continue;
      if (!(travel.last > travel.first)) {
        throw InputError(fmt::format(
            "{}: row {}: {:c}_mm is {:.6g}, but the machine has no axis {:c}: add it to the chain "
            "and as [axis.{:c}], or leave the column out",
            name, dwell.first_row + 1, 'x' + axis, position / kMillimetre, 'X' + axis, 'X' + axis));
      }
      throw InputError(fmt::format(
          "{}: row {}: {:c}_mm is {:.6g}, far outside the travel of {:.6g} to {:.6g} mm: check the "
          "unit, the scale and the word order of that channel, or travel_mm of [axis.{:c}]",
          name, dwell.first_row + 1, 'x' + axis, position / kMillimetre, travel.first / kMillimetre,
          travel.last / kMillimetre, 'X' + axis));
    }
  }
}

void RefuseStillProbes(const std::string& name, const SweepDwells& sweep) {
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    const auto gap = [probe](const Dwell& dwell) { return dwell.gap[probe]; };
    const auto [low, high] = std::ranges::minmax(sweep.dwells, {}, gap);
    if (high.gap[probe] - low.gap[probe] > kStill || sweep.scatter[probe].white > kStill) continue;
    throw InputError(fmt::format(
        "{}: {}_um shows {:.6g} um in every dwell: the amplifier is off, the probe is not "
        "connected, or another register is read; check its channel and record again",
        name, NameOfProbe(probe), low.gap[probe] / kMicrometre));
  }
}

void RefuseNoGaps(const std::string& name, const SweepDwells& sweep, const HeadSettings& head) {
  std::array<double, kProbes> largest{};
  for (const Dwell& dwell : sweep.dwells) {
    for (std::size_t probe = 0; probe < kProbes; ++probe) {
      largest[probe] = std::max(largest[probe], dwell.gap[probe]);
      if (largest[probe] > kNextToNothing * head.probes[probe].range) return;
    }
  }
  throw InputError(fmt::format(
      "{}: the gaps are {:.3g} um at most, the range is {:.6g} um: the probes would touch the "
      "target, so these are not micrometres; correct the scale of the channels, or range_um",
      name, *std::ranges::max_element(largest) / kMicrometre,
      head.probes.front().range / kMicrometre));
}

// The names of the probes for which `is` returns true: "probe_a, probe_c".
template <typename Is>
std::string ProbesThat(Is is) {
  std::string names;
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    if (is(probe)) names += (names.empty() ? "" : ", ") + NameOfProbe(probe);
  }
  return names;
}

}  // namespace

void RefuseSlips(const std::string& name, const SweepDwells& sweep, const machine::Machine& machine,
                 const HeadSettings& head) {
  RefuseFarPositions(name, sweep, machine);
  RefuseNoGaps(name, sweep, head);
  RefuseStillProbes(name, sweep);
}

std::vector<std::string> SlipNotes(const SweepDwells& sweep, const NoiseFigures& noise,
                                   const ProbeNoise& stated) {
  std::vector<std::string> notes;
  const bool repeats =
      std::ranges::any_of(sweep.dwells, [](const Dwell& d) { return d.samples > 1; });
  const auto white = [&](std::size_t probe) { return sweep.scatter[probe].white; };
  const std::string silent = ProbesThat([&](std::size_t probe) { return white(probe) <= kStill; });
  if (repeats && !silent.empty()) {
    notes.push_back(fmt::format(
        "{} show no noise at all within the dwells, as no probe does: registers that are seldom "
        "renewed, a coarse scale or unit, or computed readings; the uncertainty lacks their noise",
        silent));
  }
  const std::string odd = ProbesThat([&](std::size_t probe) {
    return white(probe) > kStill && stated.probe > 0.0 &&
           std::abs(std::log(white(probe) / stated.probe)) > std::log(kOtherUnit);
  });
  if (!odd.empty()) {
    notes.push_back(fmt::format(
        "the noise of {} is not that of noise.probe_nm by a factor above {:.0f}: a slip "
        "of units in the scale of the channels, or in the machine file",
        odd, kOtherUnit));
  }
  if (noise.dof > 0.0 && noise.chi2 < noise.dof / kOtherUnit) {
    notes.push_back(fmt::format(
        "the passes agree far better than their noise allows (chi2 {:.3g} for {:.0f} degrees of "
        "freedom): a slip of units, one pass copied, or noise and drift stated too large",
        noise.chi2, noise.dof));
  }
  return notes;
}

}  // namespace abbe::probes
