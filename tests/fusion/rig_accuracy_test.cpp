// The calibration against the linkage of the virtual rig, which has conventions of its own: are the
// stated uncertainties of ball positions true, and could anybody do better? One world a seed
// (tests/seeds.h), drawn from the tolerances of machines/demo_mill.toml, noise 3 urad and 0.3 um.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <string>

#include "../folders.h"
#include "fusion/calibrate.h"
#include "linkage_world.h"
#include "random/counter_random.h"
#include "rig/linkage.h"
#include "settings/document.h"
#include "study/bound/rig_linkage_bound.h"
#include "tests/pull_statistics.h"
#include "tests/seeds.h"

namespace abbe::fusion {
namespace rig_accuracy_test {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kPlaces = 40;
constexpr double kCoverage = 1.96;

settings::Document Mill() { return settings::Document::Read(DemoMillFile()); }

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

// What the rig drew, by the names of the complete model. A pivot of the rig is put askew about u,
// then about v, then shifted along u and v; the place and direction of its axis tell by how much.
// Encoders: the rig says what they show at a turn, the model what the turn is: the other sign.
class TruthOfRig {
 public:
  TruthOfRig(const rig::Linkage& linkage, const relm::LinkageSettings& settings) {
    const auto& drawn = linkage.settings();
    const auto& pivots = linkage.pivots();
    const Vector3d elbow = drawn.link_1 * Vector3d::UnitX();
    TakePivot("pivot_1", pivots[0], Vector3d::Zero(), Vector3d::UnitY());
    TakePivot("pivot_2", pivots[1], Vector3d::Zero(), -Vector3d::UnitZ());
    TakePivot("pivot_3", pivots[2], elbow, -Vector3d::UnitZ());
    const Vector3d ball = carried_.inverse() * linkage.ball() - elbow;
    truth_["ball.along"] = ball.z() - drawn.link_2;
    truth_["ball.across"] = ball.x();
    truth_["ball.axial"] = ball.y();
    truth_["expansion.after_pivot_2"] = linkage.expansion()[0];
    truth_["expansion.after_pivot_3"] = linkage.expansion()[1];
    const Vector3d base = linkage.base().translation - settings.X_MB.p;
    const Eigen::AngleAxisd turn(linkage.base().rotation);
    for (int i = 0; i < 3; ++i) {
      truth_[std::string("base.") + "xyz"[i]] = base[i];
      truth_[std::string("base_turn.") + "abc"[i]] = turn.angle() * turn.axis()[i];
    }
  }

  double operator[](const std::string& name) const { return truth_.at(name); }

 private:
  void TakePivot(const std::string& name, const rig::PivotTruth& pivot, const Vector3d& point,
                 const Vector3d& v) {
    using Eigen::AngleAxisd, Eigen::Translation3d;
    const Vector3d u = Vector3d::UnitX(), axis = u.cross(v);
    const Vector3d leaning = carried_.rotation().transpose() * pivot.direction;
    const double about_v = std::asin(leaning.dot(v.cross(axis)));
    const double about_u = std::atan2(leaning.dot(u.cross(axis)), leaning.dot(axis));
    const Eigen::Quaterniond askew = AngleAxisd(about_u, u) * AngleAxisd(about_v, v);
    // Along its own axis a pivot shifts nothing but what it carries: left to the next one.
    const Vector3d place = askew.inverse() * (carried_.inverse() * pivot.point - point);
    const Vector3d shift = place - axis * axis.dot(place);
    truth_["tilt." + name + "_u"] = about_u;
    truth_["tilt." + name + "_v"] = about_v;
    truth_["shift." + name + "_u"] = shift.dot(u);
    truth_["shift." + name + "_v"] = shift.dot(v);
    carried_ = carried_ * Translation3d(point) * askew * Translation3d(shift - point);
    truth_["encoder_offset." + name] = -pivot.encoder_zero;
    for (const rig::Harmonic& wave : pivot.encoder) {
      Take((wave.order == 1 ? "eccentricity." : "graduation.") + name, wave, -1.0);
    }
    for (const rig::Harmonic& wave : pivot.run_out[0]) Take("bearing." + name + "_u", wave, 1.0);
    for (const rig::Harmonic& wave : pivot.run_out[1]) Take("bearing." + name + "_v", wave, 1.0);
    truth_["compliance." + name] = pivot.give;
  }

  void Take(const std::string& name, const rig::Harmonic& wave, double sign) {
    truth_[fmt::format("{}_sin_{}", name, wave.order)] = sign * wave.sine;
    truth_[fmt::format("{}_cos_{}", name, wave.order)] = sign * wave.cosine;
  }

  std::map<std::string, double> truth_;
  Eigen::Isometry3d carried_ = Eigen::Isometry3d::Identity();
};

// Squared errors of all parameters over their variance, a mean: apart, and all together.
struct ParameterPulls {
  Mean apart, together;
  double count = 0.0;  // parameters

  void Add(const estimation::Result& fit, const TruthOfRig& truth) {
    const auto n = static_cast<Index>(fit.names.size());
    count = static_cast<double>(n);
    VectorXd error(n);
    for (Index i = 0; i < n; ++i) {
      const std::string& name = fit.names[static_cast<std::size_t>(i)];
      error[i] = fit.Value(name) - truth[name];
    }
    const VectorXd u = fit.covariance.diagonal().cwiseSqrt();
    const VectorXd pull = error.cwiseQuotient(u);
    const Eigen::MatrixXd correlation =
        u.cwiseInverse().asDiagonal() * fit.covariance * u.cwiseInverse().asDiagonal();
    apart.Add(pull.squaredNorm() / count);
    together.Add(pull.dot(correlation.llt().solve(pull)) / count);
  }
};

TEST(RigAccuracy, OfTheCompleteModelOverTheTravel) {
  const auto document = Mill();
  const auto settings = relm::ReadLinkageSettings(document.Root());
  const auto drawn = rig::ReadLinkage(document.Root());
  const Vector3d travel(0.060, 0.060, 0.060);
  const Matrix3Xd positions = GridPositions(travel, {5, 5, 5});
  const Matrix3Xd places = RandomPositions(travel, kPlaces, 1);
  const VectorXd warmth = WarmthOf(positions.cols());
  const study::RigLinkageBound own(drawn);
  const auto in_base = [&](const Matrix3Xd& at) {
    return Matrix3Xd(PlacesAt(at).colwise() - settings.X_MB.p);
  };
  const double bound =
      own.Variance(own.Covariance(in_base(positions), warmth), in_base(places), 0.5);
  Pulls pulls;
  Mean to_bound, stated;
  ParameterPulls parameters;
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
    parameters.Add(report.fit, TruthOfRig(linkage, settings));
    to_bound.Add(error.squaredNorm() / bound);
    stated.Add(u.squaredNorm() / bound);
  }
  const double ratio = std::sqrt(to_bound.mean());
  fmt::print(
      "the rig's linkage, {} seeds: error/u of ball positions has mean {:+.3f}, variance {:.3f}, "
      "{:.1f} % inside U95; rms 3D error / bound {:.3f} +- {:.3f} (the bound: {:.3f} um); u / "
      "bound {:.3f}\n{} parameters: pulls have variance {:.3f} +- {:.3f}, all together {:.3f} +- "
      "{:.3f}\n",
      pulls.pull.count, pulls.pull.mean(), pulls.square.mean(), 100.0 * pulls.inside.mean(), ratio,
      to_bound.error() / (2.0 * ratio), 1e6 * std::sqrt(bound / kPlaces), std::sqrt(stated.mean()),
      parameters.count, parameters.apart.mean(), parameters.apart.error(),
      parameters.together.mean(), parameters.together.error());
  pulls.ExpectTrueUncertainties();
  EXPECT_NEAR(parameters.apart.mean(), 1.0, k99 * parameters.apart.error());
  // Chi-squared of all parameters in every seed.
  EXPECT_NEAR(parameters.together.mean(), 1.0,
              k99 * std::sqrt(2.0 / (parameters.count * parameters.together.count)) +
                  kOfProducts / parameters.count);
  EXPECT_LT(ratio, 1.05);
  EXPECT_GT(to_bound.mean(), 1.0 - 4.0 * to_bound.error());
}

}  // namespace rig_accuracy_test
}  // namespace abbe::fusion
