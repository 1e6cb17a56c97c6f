// Is U95 of a sweep true where target and noise are not as the machine file says: a less flat
// target, larger noise, noise with heavy tails or with memory?
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "../folders.h"
#include "probes/sweep_reduction.h"
#include "random/counter_random.h"
#include "rig/record_sweep.h"
#include "tests/probes/cramer_rao_bound.h"
#include "tests/pull_statistics.h"
#include "tests/seeds.h"

namespace abbe::probes {
namespace other_sweep_test {

constexpr double kRate = 50.0;  // readings in a second
constexpr double kNano = 1e-9, kMicro = 1e-6;

using random::CounterRandom;
using Change = std::function<void(rig::RigSettings&)>;
// Standard normal numbers of one probe, one a row, into what is added to it, m.
using Extra = std::function<std::vector<double>(const CounterRandom&, std::size_t)>;

// Student's t of three degrees of freedom.
std::vector<double> HeavyTails(const CounterRandom& random, std::size_t rows) {
  std::vector<double> noise(rows);
  for (std::size_t i = 0; i < rows; ++i) {
    const double squares = std::pow(random.Normal(4 * i + 1), 2) +
                           std::pow(random.Normal(4 * i + 2), 2) +
                           std::pow(random.Normal(4 * i + 3), 2);
    noise[i] = 30.0 * kNano * random.Normal(4 * i) / std::sqrt(squares / 3.0);
  }
  return noise;
}

// A Markov process of 20 nm that forgets in this time, s.
Extra Memory(double time) {
  return [=](const CounterRandom& random, std::size_t rows) {
    const double kept = std::exp(-1.0 / (kRate * time)), fresh = std::sqrt(1.0 - kept * kept);
    std::vector<double> noise(rows);
    double now = random.Normal(0);
    for (std::size_t i = 0; i < rows; ++i) {
      now = kept * now + fresh * random.Normal(i + 1);
      noise[i] = 20.0 * kNano * now;
    }
    return noise;
  };
}

// Each half of a pass at another place and tilt, as a head that settles or warms.
Extra EachHalf(std::size_t passes) {
  return [=](const CounterRandom& random, std::size_t rows) {
    const std::size_t halves = 2 * passes;
    std::vector<double> noise(rows);
    for (std::size_t i = 0; i < rows; ++i) {
      const std::size_t half = i * halves / rows;
      const double along = static_cast<double>(i * halves % rows) / static_cast<double>(rows);
      noise[i] =
          100.0 * kNano * (random.Normal(2 * half) + (along - 0.5) * random.Normal(2 * half + 1));
    }
    return noise;
  };
}

// A probe that warms up by about 1 um, most of it in the first quarter of the run.
std::vector<double> WarmingUp(const CounterRandom& random, std::size_t rows) {
  std::vector<double> drift(rows);
  for (std::size_t i = 0; i < rows; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(rows);
    drift[i] = -kMicro * random.Normal(0) * std::expm1(-4.0 * share);
  }
  return drift;
}

// The zero of one probe, drawn, jumps by about 1 um at a time that is drawn.
std::vector<double> Jump(const CounterRandom& random, std::size_t rows) {
  std::vector<double> zero(rows);
  const double at = std::abs(std::remainder(random.Normal(0), 1.0)) + 0.25;  // 0.25 to 0.75
  if (random.Normal(1) < 0.84) return zero;                                  // one in five jumps
  for (std::size_t i = 0; i < rows; ++i) {
    zero[i] =
        static_cast<double>(i) > at * static_cast<double>(rows) ? kMicro * random.Normal(2) : 0.0;
  }
  return zero;
}

// Each probe is off for a 300th of the time, by 2 um or more.
std::vector<double> Shock(const CounterRandom& random, std::size_t rows) {
  std::vector<double> off(rows);
  const auto at = static_cast<std::size_t>(std::abs(std::remainder(random.Normal(0), 1.0)) * 300.0);
  const std::size_t first = at * rows / 300, last = std::min(rows, (at + 1) * rows / 300);
  const double size = random.Normal(1);
  for (std::size_t i = first; i < last; ++i)
    off[i] = kMicro * (3.0 * size + std::copysign(2.0, size));
  return off;
}

struct Row {
  std::string name;
  Change change = {};
  Extra extra = {};
  int passes = 0;               // 0: as the machine file plans
  double least = 0.92;          // share inside U95
  const char* note = nullptr;   // contains this
  bool form_is_unsure = false;  // drawn anew for each world, known to a factor of two
};

struct Found {
  Mean inside, seen, noted;  // a world, a reversal, a world
};

class Sweeps {
 public:
  Sweeps()
      : document_(settings::Document::Read(DemoMillFile())),
        channels_(rig::ChannelsOf(hal::ReadDevices(document_.Root().Child("devices")))) {}

  // With a head and a target without errors: nothing but noise, and what probes depart from a
  // straight characteristic, drawn and stated, m.
  Found OfNoise(const Row& row, double linearity = 0.0, double stated = 0.0) const {
    SweepSetup setup = ReadSweepSetup(document_.Root());
    setup.head.tolerance = {};
    setup.head.tolerance.linearity = stated;
    if (stated == 0.0) setup.head.assumed.insert("head.tolerance.linearity_um");
    setup.target.form = 0.0;
    rig::RigSettings rig = rig::ReadRigSettings(document_.Root());
    rig.gain = rig.probe_position = rig.form = 0.0;
    rig.installation_angle = rig.installation_offset = 0.0;
    rig.linearity = linearity;
    return Run(row, setup, rig);
  }
  Found OfAll(const Row& row) const {
    return Run(row, ReadSweepSetup(document_.Root()), rig::ReadRigSettings(document_.Root()));
  }

 private:
  Found Run(const Row& row, const SweepSetup& setup, rig::RigSettings settings) const {
    if (row.change) row.change(settings);
    const double form = settings.form;
    Found found;
    const Seeds seeds = SeedsFromEnvironment();
    for (auto seed = seeds.first; seed <= seeds.last; seed += seeds.step) {
      if (row.form_is_unsure) {
        settings.form = form * std::exp(std::log(kKnownTo) * CounterRandom(seed, 0x80).Normal(0));
      }
      Add(row, setup, settings, seed, found);
    }
    fmt::print(stderr, "{:<32}{:>7.1f}% +-{:>4.1f}% in U95, {:.1f}% of the reversals seen\n",
               row.name, 100.0 * found.inside.mean(), 100.0 * found.inside.error(),
               100.0 * found.seen.mean());
    return found;
  }

  void Add(const Row& row, const SweepSetup& setup, const rig::RigSettings& settings,
           std::uint64_t seed, Found& found) const {
    const int axis = static_cast<int>(seed % 3);
    const rig::World world(settings, seed);
    auto sweep = rig::RecordSweep(world, "XYZ" [axis], channels_,
                                  { .rate = kRate, .moving = false, .passes = row.passes });
    if (row.extra) AddExtra(row.extra, seed, sweep);
    const SweepResult result = ReduceSweep(sweep, setup);
    const Eigen::MatrixXd truth = CramerRaoBound(settings, axis, kRate).Truth(world);
    Mean inside;
    for (Eigen::Index c = 0; c < kComponents; ++c) {
      const ComponentResult& each = result.components[static_cast<std::size_t>(c)];
      for (Eigen::Index i = 1; i < truth.cols(); ++i) {  // the first one is zero by definition
        inside.Add(std::abs(each.value[i] - truth(c, i)) < each.coverage * each.u[i] ? 1.0 : 0.0);
      }
      found.seen.Add(each.reversal->seen ? 1.0 : 0.0);
    }
    found.inside.Add(inside.mean());
    if (row.note == nullptr) return;
    found.noted.Add(std::any_of(result.notes.begin(), result.notes.end(), [&](const auto& note) {
      return note.find(row.note) != std::string::npos;
    }));
  }

  static void AddExtra(const Extra& extra, std::uint64_t seed, recording::Recording& sweep) {
    for (std::uint64_t probe = 0; probe < kProbes; ++probe) {
      const std::string name = fmt::format("probe_{:c}_um", 'a' + probe);
      for (recording::Column& column : sweep.columns) {
        if (column.name != name) continue;
        const auto noise = extra(CounterRandom(seed, 0x700 + probe), column.values.size());
        for (std::size_t i = 0; i < noise.size(); ++i) column.values[i] += noise[i] / kMicro;
      }
    }
  }

  settings::Document document_;
  std::vector<hal::Channel> channels_;
};

void Check(const Row& row, const Found& found) {
  SCOPED_TRACE(row.name);
  EXPECT_GT(found.inside.mean(), row.least - k99 * found.inside.error());
  EXPECT_LE(found.seen.sum, 1.0);  // the machine has no reversal; a hundredth of all sweeps has one
  if (row.note != nullptr) {
    EXPECT_DOUBLE_EQ(found.noted.mean(), 1.0);
  }
}

TEST(SweepOfAnotherWorld, FollowsTheNoise) {
  const char* scatter = "the passes scatter";
  const auto drift = [](double factor) {
    return [=](rig::RigSettings& rig) { rig.drift *= factor; };
  };
  const std::vector<Row> rows{
      {"as stated"},
      {.name = "readings x 3", .change = [](rig::RigSettings& rig) { rig.white *= 3.0; }},
      {.name = "drift x 3", .change = drift(3.0), .note = scatter},
      {.name = "drift x 10", .change = drift(10.0), .note = scatter},
      {.name = "readings and drift x 3",
       .change =
           [](rig::RigSettings& rig) {
             rig.white *= 3.0;
             rig.drift *= 3.0;
           },
       .note = scatter},
      {.name = "drift three times as fast",
       .change = [](rig::RigSettings& rig) { rig.drift_time /= 3.0; },
       .note = scatter},
      {.name = "heavy tails", .extra = HeavyTails},
      {.name = "memory of 0.1 s", .extra = Memory(0.1), .note = scatter},
      {.name = "memory of 1 s", .extra = Memory(1.0), .note = scatter},
      {.name = "memory of 10 s", .extra = Memory(10.0), .note = scatter},
      {.name = "memory of 60 s", .extra = Memory(60.0), .note = scatter},
      {.name = "each half of a pass another", .extra = EachHalf(2), .passes = 2, .note = scatter},
      {.name = "zeros that jump", .extra = Jump},
      {.name = "a wild dwell", .extra = Shock, .note = "um off at"},
      {.name = "a wild dwell, two passes", .extra = Shock, .passes = 2, .note = "um off at"},
      {.name = "warming up", .extra = WarmingUp, .note = "drifts like one that warms up"},
      {.name = "warming up, three passes",
       .extra = WarmingUp,
       .passes = 3,
       .note = "drifts like one that warms up"},
      {.name = "drift x 3, one pass", .change = drift(3.0), .passes = 1, .note = "one pass"},
      {.name = "drift x 10, one pass",
       .change = drift(10.0),
       .passes = 1,
       .note = "one pass: forward and backward differ"},
      {.name = "warming up, one pass",
       .extra = WarmingUp,
       .passes = 1,
       .note = "one pass: forward and backward differ"}};
  const Sweeps sweeps;
  for (const Row& row : rows) Check(row, sweeps.OfNoise(row));
}

// Waves of half a period to 3.5 over the range; a target within 100 urad of the axis.
TEST(SweepOfAnotherWorld, HoldsTheLinearityOfItsProbes) {
  constexpr double kLimit = 115.0 * kNano;  // 0.1 % of 200 um / sqrt(3)
  const Sweeps sweeps;
  const Row row{.name = "linearity as stated"};
  Check(row, sweeps.OfNoise(row, kLimit, kLimit));
  const Row unsaid{.name = "linearity that is not stated",
                   .least = 0.0,
                   .note = "the linearity of the probes is not in u"};
  const Found found = sweeps.OfNoise(unsaid, kLimit);
  Check(unsaid, found);
  EXPECT_LT(found.inside.mean(), 0.85);
}

TEST(SweepOfAnotherWorld, CountsAFormThatNobodyMeasured) {
  const char* form = "rests on target.form_nm";
  const auto times = [](double factor) {
    return [=](rig::RigSettings& rig) { rig.form *= factor; };
  };
  const std::vector<Row> rows{
      {.name = "form known to a factor of two", .note = form, .form_is_unsure = true},
      // No sweep shows it: said, and covered as far as a factor of two goes, 71 and 57 %.
      {.name = "form x 3", .change = times(3.0), .least = 0.71, .note = form},
      {.name = "form x 4", .change = times(4.0), .least = 0.57, .note = form}};
  const Sweeps sweeps;
  for (const Row& row : rows) Check(row, sweeps.OfAll(row));
}

}  // namespace other_sweep_test
}  // namespace abbe::probes
