#include "probes/sweep_dwells.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "estimation/reading_step.h"
#include "estimation/robust_mean.h"
#include "failure/failure.h"
#include "probes/frozen_readings.h"
#include "recording/made_on.h"
#include "settings/unit.h"

namespace abbe::probes {
namespace {

using settings::kMicrometre;
using settings::kMillimetre;

constexpr PerProbe<std::string_view> kGapColumns = {"probe_a_um", "probe_b_um", "probe_c_um",
                                                    "probe_d_um", "probe_e_um"};

// The columns that the reduction reads, in the units of the file.
struct Rows {
  std::span<const double> time, position, pass, direction, flags;
  std::array<std::span<const double>, 3> axes;
  PerProbe<std::span<const double>> gaps;
  std::size_t first_row = 0;  // of the file
};

char SweptAxis(const recording::Recording& recording) {
  recording::RefuseOtherKind(recording, "sweep", "only a sweep has five errors");
  const std::string axis = recording.HeaderText("axis").value_or("");
  if (axis != "X" && axis != "Y" && axis != "Z") {
    throw InputError(fmt::format(
        "{}: header: axis is \"{}\"; a sweep must name its axis as axis = \"X\", \"Y\" or \"Z\"",
        recording.name, axis));
  }
  return axis.front();
}

Rows RowsOf(const recording::Recording& recording, char axis) {
  Rows rows;
  rows.time = recording.At("time_s");
  rows.position = recording.At(fmt::format("{:c}_mm", axis - 'X' + 'x'));
  rows.pass = recording.At("pass");
  rows.direction = recording.At("direction");
  rows.flags = recording.Find("flags").value_or(std::span<const double>{});
  rows.axes = {recording.At("x_mm"), recording.At("y_mm"), recording.At("z_mm")};
  rows.first_row = recording.first_row;
  for (std::size_t probe = 0; probe < kProbes; ++probe)
    rows.gaps[probe] = recording.At(kGapColumns[probe]);
  return rows;
}

// Gathers the rows of the current run and turns them into a dwell when it ends.
class DwellFinder {
 public:
  DwellFinder(const DwellRule& rule, SweepDwells& found) : rule_(rule), found_(found) {}

  void Add(const Rows& rows, std::size_t row) {
    const double time = rows.time[row], position = rows.position[row];
    if (!Continues(rows, row)) {
      Close();
      open_ = true;
      start_ = time;
      at_ = position;
      dwell_ = {.pass = static_cast<int>(rows.pass[row]),
                .direction = static_cast<int>(rows.direction[row]),
                .first_row = rows.first_row + row,
                .axes = Eigen::Vector3d(rows.axes[0][row], rows.axes[1][row], rows.axes[2][row]) *
                        kMillimetre};
    }
    if (time < start_ + rule_.settle) {
      ++found_.counts.moving;
      return;
    }
    if (gaps_[0].empty()) first_time_ = time;
    last_time_ = time;
    time_ += time;
    position_ += position;
    for (std::size_t probe = 0; probe < kProbes; ++probe) {
      gaps_[probe].push_back(rows.gaps[probe][row]);
      steps_[probe].Add(rows.gaps[probe][row]);
      readings_[probe].Add(rows.gaps[probe][row]);
    }
  }

  void Close() {
    const std::size_t samples = gaps_[0].size();
    if (open_ && samples > 0) {
      sums_.emplace_back();
      for (std::size_t probe = 0; probe < kProbes; ++probe) {
        seen_[probe].push_back(readings_[probe]);
      }
      const double n = samples;
      dwell_.time = time_ / n;
      dwell_.duration = last_time_ - first_time_;
      dwell_.position = position_ / n * kMillimetre;
      dwell_.samples = samples;
      for (std::size_t probe = 0; probe < kProbes; ++probe) dwell_.gap[probe] = Mean(probe);
      found_.dwells.push_back(dwell_);
    }
    for (std::vector<double>& gap : gaps_) gap.clear();
    readings_ = {};
    time_ = position_ = 0.0;
    open_ = false;
  }

  // Tells of the frozen dwells in `found` and leaves them out; to be called once, after the last
  // dwell was closed.
  void LeaveOutFrozen();
  // The pooled scatter of all dwells closed so far.
  PerProbe<Scatter> Scatters() const;
  PerProbe<> Steps() const {
    PerProbe<> steps{};
    for (std::size_t probe = 0; probe < kProbes; ++probe) {
      steps[probe] = steps_[probe].Step() * kMicrometre;
    }
    return steps;
  }
  // Readings that are outliers by the scatter of their dwell and by that of all dwells: of a few
  // readings the former is hardly known.
  std::size_t Outliers(const PerProbe<Scatter>& scatter) const;

 private:
  struct Sums {
    double squares = 0.0;   // m^2, of the deviations from the dwell's mean
    double products = 0.0;  // m^2, of neighbouring deviations
    double readings = 0.0;
    double pairs = 0.0;
    double dwells = 0.0;

    void Add(const Sums& other) {
      squares += other.squares;
      products += other.products;
      readings += other.readings;
      pairs += other.pairs;
      dwells += other.dwells;
    }
  };

  bool Continues(const Rows& rows, std::size_t row) const {
    return open_ && rows.pass[row] == dwell_.pass && rows.direction[row] == dwell_.direction &&
           std::abs(rows.position[row] - at_) * kMillimetre <= rule_.window;
  }

  double Mean(std::size_t probe);

  const DwellRule& rule_;
  SweepDwells& found_;
  bool open_ = false;
  Dwell dwell_;                    // the open one
  double start_ = 0.0, at_ = 0.0;  // s and mm, at its first row
  double time_ = 0.0;              // s, sum
  double first_time_ = 0.0, last_time_ = 0.0;
  double position_ = 0.0;
  PerProbe<std::vector<double>> gaps_;  // um
  PerProbe<estimation::ReadingStep> steps_;
  PerProbe<DwellReadings> readings_;           // of the open dwell
  PerProbe<std::vector<DwellReadings>> seen_;  // of each closed one
  std::vector<PerProbe<Sums>> sums_;
  PerProbe<std::vector<double>> far_;  // m, deviations of the outliers of each dwell
};

double DwellFinder::Mean(std::size_t probe) {
  const std::vector<double>& readings = gaps_[probe];
  const estimation::RobustMean mean = estimation::HuberMean(readings);
  Sums& sums = sums_.back()[probe];
  sums.dwells += 1.0;
  const double widest = estimation::RobustMeanOptions{}.outlier_at * mean.scale;
  double before = std::numeric_limits<double>::quiet_NaN();  // an outlier has no neighbours
  for (const double reading : readings) {
    const bool outlier = std::abs(reading - mean.mean) > widest;
    const double deviation = (reading - mean.mean) * kMicrometre;
    if (outlier) far_[probe].push_back(std::abs(deviation));
    if (!outlier) {
      sums.squares += deviation * deviation;
      sums.readings += 1.0;
    }
    if (!outlier && !std::isnan(before)) {
      sums.products += deviation * before;
      sums.pairs += 1.0;
    }
    before = outlier ? std::numeric_limits<double>::quiet_NaN() : deviation;
  }
  return mean.mean * kMicrometre;
}

PerProbe<Scatter> DwellFinder::Scatters() const {
  PerProbe<Scatter> scatter;
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    Sums sums;
    for (const PerProbe<Sums>& dwell : sums_) sums.Add(dwell[probe]);
    const double dof = sums.readings - sums.dwells;
    if (dof < 1.0 || sums.squares <= 0.0 || sums.pairs <= 0.0) continue;
    // Taking off the mean of n white readings leaves a correlation of -1/n between neighbours.
    const double lag1 = (sums.products / sums.pairs) / (sums.squares / sums.readings);
    scatter[probe] = {std::sqrt(sums.squares / dof), lag1 + sums.dwells / sums.readings, dof};
  }
  return scatter;
}

std::size_t DwellFinder::Outliers(const PerProbe<Scatter>& scatter) const {
  std::size_t outliers = 0;
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    const double widest = estimation::RobustMeanOptions{}.outlier_at * scatter[probe].white;
    outliers += std::ranges::count_if(far_[probe], [&](double far) { return far > widest; });
  }
  return outliers;
}

void DwellFinder::LeaveOutFrozen() {
  std::vector<bool> frozen(found_.dwells.size());
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    for (const FrozenRun& run : FindFrozen(seen_[probe])) {
      found_.frozen.push_back({probe, run.reading * kMicrometre, run.last - run.first + 1,
                               found_.dwells[run.first], found_.dwells[run.last]});
      for (std::size_t i = run.first; i <= run.last; ++i) frozen[i] = true;
    }
  }
  std::vector<Dwell> kept;
  std::vector<PerProbe<Sums>> sums;
  for (std::size_t i = 0; i < frozen.size(); ++i) {
    if (frozen[i]) {
      found_.counts.flagged += found_.dwells[i].samples;
      continue;
    }
    kept.push_back(found_.dwells[i]);
    sums.push_back(sums_[i]);
  }
  found_.dwells = std::move(kept);
  sums_ = std::move(sums);
}

void RefuseImpossibleGap(const recording::Recording& recording, const Rows& rows, std::size_t row,
                         const PerProbe<>& ranges) {
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    const double gap = rows.gaps[probe][row];
    const double range = ranges[probe] / kMicrometre;
    if (gap >= 0.0 && gap <= range) continue;
    throw InputError(
        fmt::format("{}: row {}: {} is {:.6g} um without a flag, the probe's range is 0 to {:.6g} "
                    "um; flag the row "
                    "(flags = 2) or correct range_um in the machine file",
                    recording.name, rows.first_row + row + 1, kGapColumns[probe], gap, range));
  }
}

bool IsGood(const Rows& rows, std::size_t row) {
  double sum = rows.time[row] + rows.position[row] + rows.pass[row] + rows.direction[row];
  for (const auto& gap : rows.gaps) sum += gap[row];
  const bool flagged = !rows.flags.empty() && rows.flags[row] != 0.0;
  return !flagged && !std::isnan(sum);
}

double Median(std::vector<double> values) {
  const auto middle = values.begin() + (values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void DropDwells(SweepDwells& found, const std::function<bool(const Dwell&)>& unwanted) {
  std::erase_if(found.dwells, [&](const Dwell& dwell) {
    const bool drop = unwanted(dwell);
    if (drop) found.counts.moving += dwell.samples;
    return drop;
  });
}

// Drops standstills outside the passes, turning points and other short stops.
void DropOtherStandstills(SweepDwells& found) {
  DropDwells(found, [](const Dwell& dwell) { return dwell.pass == 0 || dwell.direction == 0; });
  if (found.dwells.empty()) return;
  std::vector<double> samples;
  for (const Dwell& dwell : found.dwells) samples.push_back(dwell.samples);
  const double least = Median(samples) / 4.0;
  DropDwells(found, [&](const Dwell& dwell) { return dwell.samples < least; });
}

// Dwells nearer to their neighbour than the window belong to one station.
void AssignStations(double window, SweepDwells& found) {
  std::vector<std::size_t> order(found.dwells.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return found.dwells[a].position < found.dwells[b].position;
  });
  std::vector<double> counts;
  double before = 0.0;
  for (const std::size_t i : order) {
    Dwell& dwell = found.dwells[i];
    if (counts.empty() || dwell.position - before > window) {
      counts.push_back(0.0);
      found.stations.push_back(0.0);
    }
    dwell.station = counts.size() - 1;
    counts.back() += 1.0;
    found.stations.back() += (dwell.position - found.stations.back()) / counts.back();
    before = dwell.position;
  }
}

void AddRows(const recording::Recording& recording, const PerProbe<>& ranges, DwellFinder& finder,
             SweepDwells& found) {
  const Rows rows = RowsOf(recording, found.axis);
  found.counts.rows += rows.time.size();
  for (std::size_t row = 0; row < rows.time.size(); ++row) {
    if (!IsGood(rows, row)) {
      ++found.counts.flagged;
      continue;
    }
    RefuseImpossibleGap(recording, rows, row, ranges);
    finder.Add(rows, row);
  }
}

}  // namespace

std::string SweepDwells::FrozenText() const {
  const auto place = [&](const Dwell& dwell) {
    return fmt::format("pass {} {}, {:c} = {:.6g} mm", dwell.pass,
                       dwell.direction > 0 ? "forward" : "backward", axis,
                       dwell.position / kMillimetre);
  };
  std::string text;
  for (const FrozenStretch& each : frozen) {
    text +=
        fmt::format("{}probe_{:c} shows {:.6g} um to the last digit in {} dwells, from {} to {}",
                    text.empty() ? "" : "; ", 'a' + each.probe, each.reading / kMicrometre,
                    each.dwells, place(each.first), place(each.last));
  }
  return text;
}

DwellRule DwellRuleOf(const recording::Recording& recording) {
  return {recording.HeaderNumber("sweep.window_um", 0.0).value_or(20.0) * kMicrometre,
          recording.HeaderNumber("sweep.settle_s", 0.0).value_or(0.1)};
}

SweepDwells FindDwells(const recording::Recording& head, const recording::Blocks& blocks,
                       const DwellRule& rule, const PerProbe<>& ranges) {
  SweepDwells found;
  found.axis = SweptAxis(head);
  DwellFinder finder(rule, found);
  blocks([&](const recording::Recording& block) { AddRows(block, ranges, finder, found); });
  finder.Close();
  finder.LeaveOutFrozen();
  DropOtherStandstills(found);
  if (found.dwells.empty()) {
    throw InputError(fmt::format(
        "{}: no dwell found: the {} axis never stands within {} um for longer than {} s; set "
        "sweep.window_um and sweep.settle_s in the header",
        head.name, found.axis, rule.window / kMicrometre, rule.settle));
  }
  AssignStations(rule.window, found);
  found.start = found.dwells.front().axes;
  found.start[found.axis - 'X'] = found.stations[found.dwells.front().station];
  found.scatter = finder.Scatters();
  found.step = finder.Steps();
  found.counts.outliers = finder.Outliers(found.scatter);
  for (const Dwell& dwell : found.dwells) found.counts.used += dwell.samples;
  return found;
}

SweepDwells FindDwells(const recording::Recording& recording, const DwellRule& rule,
                       const PerProbe<>& ranges) {
  return FindDwells(
      recording, [&](const auto& use) { use(recording); }, rule, ranges);
}

}  // namespace abbe::probes
