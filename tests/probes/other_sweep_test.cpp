// Is U95 of a sweep true where target and noise are not as the machine file says: a less flat
// target, larger noise, noise with heavy tails or with memory?
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "probes/sweep_reduction.h"
#include "random/counter_random.h"
#include "rig/record_sweep.h"
#include "tests/probes/cramer_rao_bound.h"
#include "tests/pull_statistics.h"
#include "tests/seeds.h"

namespace abbe::probes {
namespace other_sweep_test {

constexpr double kRate = 50.0;  // readings in a second
constexpr double kNano = 1e-9;

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

// A Markov process of 20 nm that forgets in `rows_of_memory` rows.
Extra Memory(double rows_of_memory) {
  return [=](const CounterRandom& random, std::size_t rows) {
    const double kept = std::exp(-1.0 / rows_of_memory), fresh = std::sqrt(1.0 - kept * kept);
    std::vector<double> noise(rows);
    double now = random.Normal(0);
    for (std::size_t i = 0; i < rows; ++i) {
      now = kept * now + fresh * random.Normal(i + 1);
      noise[i] = 20.0 * kNano * now;
    }
    return noise;
  };
}

struct Row {
  std::string name;
  Change change = {};
  Extra extra = {};
};

std::vector<Row> Rows() {
  return {{"as stated"},
          {"form x 3", [](rig::RigSettings& rig) { rig.form *= 3.0; }},
          {"form x 4", [](rig::RigSettings& rig) { rig.form *= 4.0; }},
          {"form / 3", [](rig::RigSettings& rig) { rig.form /= 3.0; }},
          {"white x 3", [](rig::RigSettings& rig) { rig.white *= 3.0; }},
          {"drift x 3", [](rig::RigSettings& rig) { rig.drift *= 3.0; }},
          {"both x 3",
           [](rig::RigSettings& rig) {
             rig.white *= 3.0;
             rig.drift *= 3.0;
           }},
          {"drift 3 x faster", [](rig::RigSettings& rig) { rig.drift_time /= 3.0; }},
          {"drift 3 x slower", [](rig::RigSettings& rig) { rig.drift_time *= 3.0; }},
          {"drift 0", [](rig::RigSettings& rig) { rig.drift = 0.0; }},
          {"form 0 drift x 10", [](rig::RigSettings& rig) { rig.drift *= 10.0; }},
          {"t-tailed", {}, HeavyTails},
          {"memory 0.1 s", {}, Memory(5.0)},
          {"memory 1 s", {}, Memory(50.0)},
          {"memory 10 s", {}, Memory(500.0)},
          {"memory 60 s", {}, Memory(3000.0)}};
}

TEST(OtherSweep, Study) {
  const auto document =
      settings::Document::Read(std::string(ABBE_SOURCE_DIR) + "/machines/demo_mill.toml");
  const auto channels = rig::ChannelsOf(hal::ReadDevices(document.Root().Child("devices")));
  const char* noform = std::getenv("NOFORM");
  const char* npass = std::getenv("PASSES");
  const Seeds seeds = SeedsFromEnvironment();
  for (const Row& row : Rows()) {
    SweepSetup setup = ReadSweepSetup(document.Root());
    rig::RigSettings settings = rig::ReadRigSettings(document.Root());
    if (noform) {
      setup.head.tolerance = {};
      setup.target.form = 0.0;
      settings.gain = settings.probe_position = settings.form = 0.0;
      settings.installation_angle = settings.installation_offset = 0.0;
    }
    if (row.change) row.change(settings);
    Mean inside, range, rev, flag, scale, ku;
    for (auto seed = seeds.first; seed <= seeds.last; seed += seeds.step) {
      const int axis = static_cast<int>(seed % 3);
      const rig::World world(settings, seed);
      rig::RecordSweepOptions o{.rate = kRate, .moving = false};
      if (npass) o.passes = std::atoi(npass);
      auto sweep = rig::RecordSweep(world, "XYZ"[axis], channels, o);
      if (row.extra) {
        for (std::uint64_t probe = 0; probe < kProbes; ++probe) {
          auto& values =
              std::find_if(sweep.columns.begin(), sweep.columns.end(), [&](const auto& c) {
                return c.name == fmt::format("probe_{:c}_um", 'a' + probe);
              })->values;
          const auto noise = row.extra(CounterRandom(seed, 0x700 + probe), values.size());
          for (std::size_t i = 0; i < values.size(); ++i) values[i] += 1e6 * noise[i];
        }
      }
      const SweepResult result = ReduceSweep(sweep, setup);
      const CramerRaoBound bound(settings, axis, kRate);
      const Eigen::MatrixXd truth = bound.Truth(world);
      Mean here;
      for (Eigen::Index c = 0; c < kComponents; ++c) {
        const ComponentResult& found = result.components[static_cast<std::size_t>(c)];
        for (Eigen::Index i = 1; i < truth.cols(); ++i)
          here.Add(std::abs(found.value[i] - truth(c, i)) < found.coverage * found.u[i]);
        ku.Add(found.coverage);
        if (found.reversal) rev.Add(found.reversal->seen);
      }
      inside.Add(here.mean());
      scale.Add(result.noise.scale);
      flag.Add(!result.notes.empty());
    }
    fmt::print("{:<22}{:>8.1f}% +-{:>5.1f}%  scale {:.2f} k {:.2f} reversals seen {:.4f} notes {:.2f}\n", row.name,
               100.0 * inside.mean(), 100.0 * inside.error(), scale.mean(), ku.mean(), rev.mean(), flag.mean());
    std::fflush(stdout);
  }
}

}  // namespace other_sweep_test
}  // namespace abbe::probes
