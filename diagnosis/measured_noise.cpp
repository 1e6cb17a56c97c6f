#include "diagnosis/measured_noise.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "recording/good_rows.h"
#include "simulation/kinds.h"

namespace abbe::diagnosis {
namespace {

using recording::Recording;

constexpr double kTrembles = 5e-6;          // m
constexpr double kPauseBetweenStays = 0.5;  // s: rows farther apart belong to two standstills
constexpr double kBelieved = 0.05, kCertain = 4.0;

// Rows whose axes stand where they stood in the row before, by the column's own rows.
std::vector<bool> Stands(const Recording& recording, const std::vector<std::size_t>& rows) {
  const bool knows_axes =
      recording.Find("x_mm") || recording.Find("y_mm") || recording.Find("z_mm");
  std::vector<bool> stands(rows.size(), knows_axes);
  stands.front() = false;
  for (const char* axis : {"x_mm", "y_mm", "z_mm"}) {
    if (!recording.Find(axis)) continue;
    const auto place = recording::ValuesOf(recording, axis, rows);
    for (std::size_t i = 1; i < rows.size(); ++i) {
      stands[i] = stands[i] && std::abs(place[i] - place[i - 1]) < kTrembles;
    }
  }
  if (!recording.Find("time_s")) return stands;
  const auto time = recording::ValuesOf(recording, "time_s", rows);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    stands[i] = stands[i] && time[i] - time[i - 1] < kPauseBetweenStays;
  }
  return stands;
}

// The median of those that tell anything.
StillNoise MedianOf(std::vector<StillNoise> channels) {
  std::erase_if(channels, [](const StillNoise& each) { return each.freedom < 1.0; });
  if (channels.empty()) return {};
  const auto middle = channels.begin() + static_cast<std::ptrdiff_t>(channels.size() / 2);
  std::nth_element(channels.begin(), middle, channels.end(),
                   [](const StillNoise& a, const StillNoise& b) { return a.sd < b.sd; });
  return *middle;
}

struct Kind {
  std::string name, unit;
  double scale;
  std::vector<std::string> columns;
};

void Replace(const std::vector<Recording>& recordings, const Kind& kind, double& stated,
             std::vector<std::string>& notes) {
  std::vector<StillNoise> channels;
  for (const std::string& column : kind.columns) {
    channels.push_back(NoiseAtRest(recordings, column));
  }
  const StillNoise found = MedianOf(std::move(channels));
  if (found.freedom < 1.0) return;
  const double doubt = kCertain / std::sqrt(2.0 * found.freedom);
  if (std::abs(found.sd / stated - 1.0) <= std::max(kBelieved, doubt)) return;
  notes.push_back(fmt::format(
      "noise of the {}: {:.3g} {} where nothing moves ({:.0f} degrees of freedom), not {:.3g} {} "
      "as the machine file states; what was measured counts",
      kind.name, found.sd / kind.scale, kind.unit, found.freedom, stated / kind.scale, kind.unit));
  stated = found.sd;
}

}  // namespace

StillNoise NoiseAtRest(const std::vector<Recording>& recordings, const std::string& column) {
  double sum = 0.0, pairs = 0.0;
  for (const Recording& recording : recordings) {
    if (!recording.Find(column) || !simulation::KindOf(recording).ShowsNoiseAtRest()) continue;
    if (!recording::HasGoodRow(recording)) continue;
    const auto rows = recording::GoodRows(recording);
    const auto values = recording::ValuesOf(recording, column, rows);
    const auto stands = Stands(recording, rows);
    for (std::size_t i = 1; i < rows.size(); ++i) {
      if (!stands[i]) continue;
      sum += 0.5 * std::pow(values[i] - values[i - 1], 2);
      pairs += 1.0;
    }
  }
  if (pairs == 0.0) return {};
  return {std::sqrt(sum / pairs), 2.0 / 3.0 * pairs};
}

void UseMeasuredNoise(const std::vector<Recording>& recordings,
                      simulation::Instruments& instruments) {
  if (instruments.head) {
    Kind probes{"probes", "nm", 1e-9, {}};
    for (const char letter : {'a', 'b', 'c', 'd', 'e'}) {
      probes.columns.push_back(fmt::format("probe_{}_um", letter));
    }
    Replace(recordings, probes, instruments.noise.probe, instruments.notes);
  }
  if (instruments.linkage) {
    Kind encoders{"encoders", "urad", 1e-6, {}};
    for (std::size_t i = 1; i <= static_cast<std::size_t>(instruments.linkage->chain.joints());
         ++i) {
      encoders.columns.push_back(fmt::format("pivot_{}_rad", i));
    }
    Replace(recordings, encoders, instruments.linkage->noise.encoder, instruments.notes);
  }
}

}  // namespace abbe::diagnosis
