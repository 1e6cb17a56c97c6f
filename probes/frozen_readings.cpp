#include "probes/frozen_readings.h"

#include <algorithm>
#include <cmath>

namespace abbe::probes {
namespace {

bool GoesOn(const DwellReadings& before, const DwellReadings& after) {
  return before.Constant() && after.Constant() && before.last() == after.first();
}

std::vector<FrozenRun> RunsOfOneReading(std::span<const DwellReadings> dwells) {
  std::vector<FrozenRun> runs;
  for (std::size_t i = 1; i < dwells.size(); ++i) {
    if (!GoesOn(dwells[i - 1], dwells[i])) continue;
    if (runs.empty() || runs.back().last != i - 1) runs.push_back({i - 1, i, dwells[i].first()});
    runs.back().last = i;
  }
  return runs;
}

// The dwells beside the runs together.
struct Others {
  double dwells = 0.0, constant = 0.0, readings = 0.0, squares = 0.0;
  double step = std::numeric_limits<double>::infinity();

  void Add(const DwellReadings& dwell) {
    if (dwell.count() < 2) return;
    dwells += 1.0;
    constant += dwell.Constant() ? 1.0 : 0.0;
    readings += static_cast<double>(dwell.count());
    squares += dwell.squares();
    step = std::min(step, dwell.least_change());
  }
  // The most that noise leaves one reading as the one before; 1 where that is not known.
  double Unchanged() const {
    constexpr double kSeldom = 0.1;
    if (dwells == 0.0 || constant > kSeldom * dwells) return 1.0;
    const double variance = squares / (readings - dwells) - step * step / 12.0;
    return variance > step * step ? std::erf(step / std::sqrt(8.0 * variance)) : 1.0;
  }
};

}  // namespace

void DwellReadings::Add(double reading) {
  if (count_ == 0) first_ = last_ = reading;
  const double change = std::abs(reading - last_);
  if (change > 0.0) least_change_ = std::min(least_change_, change);
  last_ = reading;
  ++count_;
  const double off = reading - mean_;
  mean_ += off / static_cast<double>(count_);
  squares_ += off * (reading - mean_);
}

std::vector<FrozenRun> FindFrozen(std::span<const DwellReadings> dwells) {
  constexpr double kChance = 1e-6;
  std::vector<FrozenRun> runs = RunsOfOneReading(dwells);
  if (runs.empty()) return runs;
  Others others;
  std::size_t next = 0;
  double all = 0.0;
  for (const FrozenRun& run : runs) {
    for (; next < run.first; ++next) others.Add(dwells[next]);
    next = run.last + 1;
  }
  for (; next < dwells.size(); ++next) others.Add(dwells[next]);
  for (const DwellReadings& dwell : dwells) all += static_cast<double>(dwell.count());
  const double unchanged = others.Unchanged();
  std::erase_if(runs, [&](const FrozenRun& run) {
    double readings = 0.0;
    for (std::size_t i = run.first; i <= run.last; ++i) {
      readings += static_cast<double>(dwells[i].count());
    }
    return all * std::pow(unchanged, readings - 1.0) >= kChance;
  });
  for (FrozenRun& run : runs) {
    if (run.first > 0 && dwells[run.first - 1].last() == run.reading) --run.first;
    if (run.last + 1 < dwells.size() && dwells[run.last + 1].first() == run.reading) ++run.last;
  }
  return runs;
}

}  // namespace abbe::probes
