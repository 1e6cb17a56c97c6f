// The reduction against the virtual rig, which shares no model with it: are the uncertainties true,
// and could anybody do better? One world a seed (tests/seeds.h).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "../folders.h"
#include "hal/modbus/modbus_device.h"
#include "probes/sweep_reduction.h"
#include "random/counter_random.h"
#include "rig/record_sweep.h"
#include "tests/probes/cramer_rao_bound.h"
#include "tests/pull_statistics.h"
#include "tests/seeds.h"

namespace abbe::probes {
namespace sweep_accuracy_test {

constexpr double kRate = 100.0;  // readings in a second

// Cuts every reading into the counts of its register.
void Digitise(const hal::DevicesSettings& devices, recording::Recording& sweep) {
  for (const hal::ModbusSettings& device : hal::SettingsOf<hal::ModbusDevice>(devices)) {
    for (const hal::BlockSettings& block : device.blocks) {
      for (const hal::ChannelSettings& channel : block.channels) {
        for (recording::Column& column : sweep.columns) {
          if (column.name != channel.name) continue;
          for (double& value : column.values) {
            value = std::round(value / channel.scale) * channel.scale;
          }
        }
      }
    }
  }
}

struct Score {
  Pulls pulls;           // of one random station and component a seed
  Mean square_to_bound;  // (error / bound)^2, mean over all stations and components of a seed
  Mean stated_to_bound;  // (u / bound)^2, the same
};

enum class Head { kAsToleranced, kPerfect };

class Campaign {
 public:
  Campaign(int axis, Head head)
      : axis_(axis),
        document_(settings::Document::Read(DemoMillFile())),
        devices_(hal::ReadDevices(document_.Root().Child("devices"))),
        setup_(ReadSweepSetup(document_.Root())),
        rig_(rig::ReadRigSettings(document_.Root())) {
    setup_.target.form_known_to = 1.0;  // the target of the rig is as flat as the file says
    if (head == Head::kPerfect) {
      setup_.head.tolerance = {};
      setup_.target.form = 0.0;
      rig_.gain = rig_.probe_position = rig_.form = 0.0;
      rig_.installation_angle = rig_.installation_offset = 0.0;
    }
  }

  Score Run(const Seeds& seeds) const {
    const CramerRaoBound bound(rig_, axis_, kRate);
    Score score;
    for (auto seed = seeds.first; seed <= seeds.last; seed += seeds.step) {
      const rig::World world(rig_, seed);
      Add(seed, Reduce(world), bound.Truth(world), bound.OfAll(world), score);
    }
    return score;
  }

 private:
  SweepResult Reduce(const rig::World& world) const {
    auto sweep = rig::RecordSweep(world, "XYZ" [axis_], rig::ChannelsOf(devices_),
                                  { .rate = kRate, .moving = false });
    Digitise(devices_, sweep);
    return ReduceSweep(sweep, setup_);
  }

  static void Add(std::uint64_t seed, const SweepResult& result, const Eigen::MatrixXd& truth,
                  const Eigen::MatrixXd& bound, Score& score) {
    const random::CounterRandom pick(seed, 0xACC);
    const auto component = static_cast<Eigen::Index>(kComponents * pick.Uniform(0));
    const auto stations = truth.cols() - 1;  // the first one is zero by definition
    const auto station =
        1 + static_cast<Eigen::Index>(static_cast<double>(stations) * pick.Uniform(1));
    double square = 0.0, stated = 0.0;
    for (Eigen::Index c = 0; c < kComponents; ++c) {
      const ComponentResult& found = result.components[static_cast<std::size_t>(c)];
      for (Eigen::Index i = 1; i <= stations; ++i) {
        const double error = found.value[i] - truth(c, i), u = found.u[i];
        const double share = 1.0 / static_cast<double>(kComponents * stations);
        square += share * std::pow(error / bound(c, i), 2);
        stated += share * std::pow(u / bound(c, i), 2);
        if (c != component || i != station) continue;
        score.pulls.Add(error, u, found.coverage);
      }
    }
    score.square_to_bound.Add(square);
    score.stated_to_bound.Add(stated);
  }

  int axis_;
  settings::Document document_;
  hal::DevicesSettings devices_;
  SweepSetup setup_;
  rig::RigSettings rig_;
};

// Half of the 10 % that may be lost is the limit, so that a true 1.00 passes and a true 1.10 fails:
// the scatter of the mean of squares says how surely. Nobody is better than the bound.
void ExpectTheBoundReached(const Score& score) {
  EXPECT_LT(std::sqrt(score.square_to_bound.mean()), 1.05);
  EXPECT_LT(k99 * score.square_to_bound.error(), 0.10);
  EXPECT_GT(score.square_to_bound.mean(), 1.0 - 4.0 * score.square_to_bound.error());
  EXPECT_NEAR(std::sqrt(score.stated_to_bound.mean()), 1.0, 0.05);
}

void Check(int axis, Head head) {
  const Score score = Campaign(axis, head).Run(SeedsFromEnvironment());
  const double ratio = std::sqrt(score.square_to_bound.mean());
  fmt::print(
      "{} axis, {}, {} seeds: error/u has mean {:+.3f}, variance {:.3f}, {:.1f} % inside U95; rms "
      "error / bound {:.3f} +- {:.3f}; u / bound {:.4f}\n",
      "XYZ"[axis], head == Head::kPerfect ? "perfect head" : "head as toleranced",
      score.pulls.pull.count, score.pulls.pull.mean(), score.pulls.square.mean(),
      100.0 * score.pulls.inside.mean(), ratio, score.square_to_bound.error() / (2.0 * ratio),
      std::sqrt(score.stated_to_bound.mean()));
  score.pulls.ExpectTrueUncertainties();
  ExpectTheBoundReached(score);
}

// The head and the target as toleranced: the form of the faces is most of the error.
TEST(SweepAccuracy, WhereTheTargetMoves) { Check(0, Head::kAsToleranced); }
TEST(SweepAccuracy, WhereTheTargetMovesInATurnedFrame) { Check(1, Head::kAsToleranced); }
TEST(SweepAccuracy, WhereTheHeadMoves) { Check(2, Head::kAsToleranced); }

// Nothing but noise: what is lost here is lost by the means over readings, passes and directions.
TEST(SweepAccuracy, OfNoiseAloneWhereTheTargetMoves) { Check(0, Head::kPerfect); }
TEST(SweepAccuracy, OfNoiseAloneWhereTheHeadMoves) { Check(2, Head::kPerfect); }

}  // namespace sweep_accuracy_test
}  // namespace abbe::probes
