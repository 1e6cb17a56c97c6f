// Copies with small changes against true repetitions, in stays of a machine that repeats far more
// than its noise: steps, settling, mains.
#include "fusion/near_copy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "random/counter_random.h"

namespace abbe::fusion {
namespace {

using recording::Column;
using recording::Recording;

constexpr int kStations = 41, kRowsOfStay = 9, kProbes = 5;
constexpr double kStep = 0.1, kNoise = 5e-3;  // s, um

// Errors of the stations that repeat, which settle at each in its own way; mains of 1 um whose phase
// does not repeat; noise of 5 nm.
Recording SweepOf(std::uint64_t machine, std::uint64_t run) {
  const random::CounterRandom world(machine, 1), draw(run, 2);
  Recording sweep{"sweep",
                  "kind = \"sweep\"",
                  {{"time_s", {}}, {"x_mm", {}}, {"y_mm", {}}, {"z_mm", {}}, {"flags", {}}},
                  {}};
  for (int probe = 0; probe < kProbes; ++probe) {
    sweep.columns.push_back({std::string("probe_") + char('a' + probe) + "_um", {}});
  }
  const double phase = 6.28 * draw.Uniform(0);
  std::uint64_t next = 1;
  for (int visit = 0; visit < 2 * kStations; ++visit) {
    const int station = visit < kStations ? visit : 2 * kStations - 1 - visit;
    for (int row = -1; row < kRowsOfStay; ++row) {
      const double time = kStep * (visit * (kRowsOfStay + 1) + row + 1);
      const double place = row < 0 ? station - 0.5 : station;
      const std::vector<double> before{time, place, 30.0, 30.0, 0.0};
      for (std::size_t c = 0; c < before.size(); ++c) sweep.columns[c].values.push_back(before[c]);
      for (int probe = 0; probe < kProbes; ++probe) {
        const double error = world.Normal(10 * visit + probe);
        const double settling =
            0.3 * world.Normal(1000 + 10 * visit + probe) * std::exp(-row / 2.0);
        const double mains = std::sin(2.0 * 3.14159265 * 49.98 * time + phase);
        sweep.columns[before.size() + probe].values.push_back(100.0 + error + settling + mains +
                                                              kNoise * draw.Normal(next++));
      }
    }
  }
  return sweep;
}

using Change = std::function<double(const std::string& column, double value)>;

// Only the rows that `kept` wants.
Recording Changed(
    const Recording& recording, const Change& change,
    const std::function<bool(std::size_t)>& kept = [](std::size_t) { return true; }) {
  Recording changed = recording;
  for (Column& column : changed.columns) {
    std::vector<double> values;
    for (std::size_t row = 0; row < column.values.size(); ++row) {
      if (kept(row)) values.push_back(change(column.name, column.values[row]));
    }
    column.values = std::move(values);
  }
  return changed;
}

bool IsProbe(const std::string& column) { return column.starts_with("probe_"); }

double Rounded(const std::string& column, double value) {
  return IsProbe(column) ? std::round(value * 1e3) / 1e3 : value;
}

TEST(NearCopy, TrueRepetitionsAreNone) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    EXPECT_FALSE(SharedNoise(SweepOf(seed, 2 * seed), SweepOf(seed, 2 * seed + 1))) << seed;
    // As an instrument reads whose steps of 10 nm are twice its noise.
    const Change steps = [](const std::string& column, double value) {
      return IsProbe(column) ? std::round(value * 1e2) / 1e2 : value;
    };
    EXPECT_FALSE(SharedNoise(Changed(SweepOf(seed, 2 * seed), steps),
                             Changed(SweepOf(seed, 2 * seed + 1), steps)))
        << seed;
  }
}

TEST(NearCopy, CopiesAreToldInEveryDisguise) {
  const Recording original = SweepOf(1, 1);
  const Change later = [](const std::string& column, double value) {
    return column == "time_s" ? value + 12.3 : IsProbe(column) ? value + 7.0 : value;
  };
  const random::CounterRandom draw(3, 3);
  std::uint64_t next = 0;
  const Change noisier = [&](const std::string& column, double value) {
    return IsProbe(column) ? value + 2e-3 * draw.Normal(next++) : value;
  };
  const auto half = [&](std::size_t row) { return row >= original.rows() / 2; };
  const auto second = [](std::size_t row) { return row % 2 == 1; };
  for (const Recording& copy :
       {Changed(original, Rounded), Changed(original, later), Changed(original, noisier),
        Changed(original, Rounded, half), Changed(original, later, second)}) {
    const auto shared = SharedNoise(original, copy);
    ASSERT_TRUE(shared);
    EXPECT_GT(*shared, 0.85);
    EXPECT_TRUE(SharedNoise(copy, original));
  }
}

// A circle never stands still: only its very readings tell.
TEST(NearCopy, WhatMovesIsACopyWithTheSameReadingsOnly) {
  const random::CounterRandom draw(4, 4);
  const auto circle = [&draw](std::uint64_t run) {
    Recording made{"circle",
                   "kind = \"ballbar\"",
                   {{"time_s", {}}, {"x_mm", {}}, {"y_mm", {}}, {"ref_radius_mm", {}}},
                   {}};
    for (int row = 0; row < 720; ++row) {
      const double turned = 3.14159265 / 360.0 * row;
      const std::vector<double> values{
          0.01 * row, 100 * std::cos(turned), 100 * std::sin(turned),
          100 + 1e-3 * std::sin(200 * turned) + 1e-6 * draw.Normal(1000 * run + row)};
      for (std::size_t c = 0; c < values.size(); ++c) made.columns[c].values.push_back(values[c]);
    }
    return made;
  };
  const Change constant = [](const std::string& column, double value) {
    return column == "ref_radius_mm" ? value + 0.25 : value;
  };
  EXPECT_EQ(SharedNoise(circle(1), Changed(circle(1), constant)), 1.0);
  EXPECT_FALSE(SharedNoise(circle(1), circle(2)));
  EXPECT_FALSE(SharedNoise(circle(1), SweepOf(1, 1)));
}

}  // namespace
}  // namespace abbe::fusion
