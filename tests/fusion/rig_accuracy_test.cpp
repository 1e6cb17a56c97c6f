// The calibration against the linkage of the virtual rig, which has conventions of its own: are the
// stated uncertainties of ball positions true, and could anybody do better? One world a seed
// (tests/seeds.h), drawn from the tolerances of machines/demo_mill.toml, noise 3 urad and 0.3 um.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "fusion/calibrate.h"
#include "linkage_world.h"
#include "random/counter_random.h"
#include "rig/linkage.h"
#include "rig_linkage_bound.h"
#include "settings/document.h"
#include "tests/pull_statistics.h"
#include "tests/seeds.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kPlaces = 40;
constexpr double kCoverage = 1.96;

settings::Document Mill() {
  return settings::Document::Read(ABBE_SOURCE_DIR "/machines/demo_mill.toml");
}

Matrix3Xd PlacesAt(const Matrix3Xd& positions) {
  Matrix3Xd p_MT = positions;  // [w X Y b Z t]
  p_MT.topRows<2>() *= -1.0;
  return p_MT;
}

// While the run lasts the links grow warmer by a degree.
VectorXd WarmthOf(Index poses) { return VectorXd::LinSpaced(poses, 0.0, 1.0); }

simulation::LinkageRun Measured(const rig::Linkage& linkage, const relm::LinkageSettings& settings,
                                const Matrix3Xd& positions, const VectorXd& warmth, bool noisy,
                                std::uint64_t seed) {
  simulation::LinkageRun run = simulation::RunAt(positions, settings);
  const Matrix3Xd p_MT = PlacesAt(positions);
  const random::CounterRandom random(seed, 0xB16);
  run.readings.warmth = warmth;
  for (Index pose = 0; pose < run.poses(); ++pose) {
    run.readings.angles.col(pose) =
        linkage.EncodersFor(p_MT.col(pose), settings.reference_temperature + warmth[pose]);
    for (int i = 0; noisy && i < 3; ++i) {
      const auto index = static_cast<std::uint64_t>(6 * pose + i);
      run.readings.angles(i, pose) += settings.noise.encoder * random.Normal(index);
      run.reference(i, pose) += settings.noise.reference * random.Normal(index + 3);
    }
  }
  return run;
}

TEST(RigAccuracy, OfTheCompleteModelOverTheTravel) {
  const auto document = Mill();
  const auto settings = relm::ReadLinkageSettings(document.Root());
  const auto drawn = rig::ReadLinkage(document.Root());
  const Vector3d travel(0.060, 0.060, 0.060);
  const Matrix3Xd positions = GridPositions(travel, {5, 5, 5});
  const Matrix3Xd places = RandomPositions(travel, kPlaces, 1);
  const VectorXd warmth = WarmthOf(positions.cols());
  const RigLinkageBound own(drawn);
  const auto in_base = [&](const Matrix3Xd& at) {
    return Matrix3Xd(PlacesAt(at).colwise() - settings.X_MB.p);
  };
  const double bound =
      own.Variance(own.Covariance(in_base(positions), warmth), in_base(places), 0.5);
  Pulls pulls;
  Mean to_bound, stated;
  const Seeds seeds = SeedsFromEnvironment();
  for (auto seed = seeds.first; seed <= seeds.last; seed += seeds.step) {
    const rig::Linkage linkage(drawn, seed);
    const auto report =
        Calibrate(WorldChain(), settings,
                  {Measured(linkage, settings, positions, warmth, true, seed)}, {.folds = 1});
    const CalibratedLinkage found(settings, report.calibration);
    const auto other =
        Measured(linkage, settings, places, VectorXd::Constant(kPlaces, 0.5), false, seed);
    const Matrix3Xd error = found.Tips(other.readings) - PlacesAt(places);
    const Matrix3Xd u = found.StandardUncertainties(other.readings);
    const random::CounterRandom pick(seed, 0xB17);
    const auto at = static_cast<Index>(error.size() * pick.Uniform(0));
    pulls.Add(error(at % 3, at / 3), u(at % 3, at / 3), kCoverage);
    to_bound.Add(error.squaredNorm() / bound);
    stated.Add(u.squaredNorm() / bound);
  }
  const double ratio = std::sqrt(to_bound.mean());
  fmt::print(
      "the rig's linkage, {} seeds: error/u of ball positions has mean {:+.3f}, variance {:.3f}, "
      "{:.1f} % inside U95; rms 3D error / bound {:.3f} +- {:.3f} (the bound: {:.3f} um); u / "
      "bound {:.3f}\n",
      pulls.pull.count, pulls.pull.mean(), pulls.square.mean(), 100.0 * pulls.inside.mean(), ratio,
      to_bound.error() / (2.0 * ratio), 1e6 * std::sqrt(bound / kPlaces), std::sqrt(stated.mean()));
  pulls.ExpectTrueUncertainties();
  EXPECT_LT(ratio, 1.10);
  EXPECT_GT(to_bound.mean(), 1.0 - 4.0 * to_bound.error());
}

}  // namespace
}  // namespace abbe::fusion
