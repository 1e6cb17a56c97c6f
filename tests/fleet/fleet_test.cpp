// Fleets drawn here: Gaussian processes on stations, not the splines and priors of the fit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "../folders.h"
#include "failure/failure.h"
#include "fleet/odd_machines.h"
#include "fleet/population_fit.h"
#include "random/counter_random.h"
#include "settings/document.h"

namespace abbe::fleet {
namespace fleet_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kMachines = 14, kStations = 31;
constexpr double kNoise = 0.02;  // of the size of a function

// What is true over what the file says, in the order of fusion::Line.
const std::vector<double> kTrue{2.0, 0.5, 1.0, 2.5, 0.6, 1.8, 1.0, 1.3};

const machine::Machine& Mill() {
  static const machine::Machine mill =
      machine::ReadMachine(settings::Document::Read(DemoMillFile()).Root());
  return mill;
}

// The errors of one machine at the stations of each function, and its squarenesses.
struct Drawn {
  std::vector<VectorXd> values;
  Eigen::Vector3d squareness;
};

class Fleet {
 public:
  Fleet() : model_(fusion::UnknownMachine(Mill(), fusion::KnotsOf(Mill()))) {}

  const machine::VolumetricModel& model() const { return model_; }

  Drawn Draw(std::uint64_t seed) const {
    const random::CounterRandom random(seed, 0xF1EE7);
    std::uint64_t at = 0;
    Drawn drawn;
    for (int axis = 0; axis < 3; ++axis) {
      const VectorXd x = Stations(axis);
      const double length = kTrue[fusion::kSmoothness] * Mill().population.smoothness;
      const MatrixXd apart =
          (x.replicate(1, kStations) - x.transpose().replicate(kStations, 1)) / length;
      MatrixXd K = (-0.5 * apart.array().square()).exp();
      K.diagonal().array() += 1e-9;
      const MatrixXd root = K.llt().matrixL();
      for (int motion = 0; motion < 6; ++motion) {
        VectorXd white(kStations);
        for (double& each : white) each = random.Normal(at++);
        drawn.values.emplace_back(Size(axis, motion) * root * white);
        if (motion != axis) continue;
        const double scale = kTrue[fusion::kScale] * Mill().population.scale * random.Normal(at++);
        drawn.values.back() += scale * x;
      }
    }
    for (double& each : drawn.squareness) {
      each = kTrue[fusion::kSquareness] * Mill().population.squareness * random.Normal(at++);
    }
    return drawn;
  }

  // Readings at the stations with noise and an unknown offset; of a straightness an unknown slope too.
  Campaign Measure(const std::string& machine, const std::string& name, const Drawn& drawn,
                   std::uint64_t seed) const {
    const random::CounterRandom random(seed, 0x2015E);
    std::uint64_t at = 0;
    const Index n = model_.ParameterCount();
    Campaign campaign{machine, name, {MatrixXd::Zero(n, n), VectorXd::Zero(n)}};
    Index first = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const VectorXd x = Stations(axis);
      for (int motion = 0; motion < 6; ++motion) {
        const auto& function = model_.Function(axis, motion);
        MatrixXd J(kStations, function.size());
        VectorXd gradient(function.size()), y = drawn.values[6 * axis + motion];
        const double noise = kNoise * Size(axis, motion);
        for (int i = 0; i < kStations; ++i) {
          function.Evaluate(x[i], nullptr, gradient.data());
          J.row(i) = gradient;
          y[i] += noise * random.Normal(at++);
        }
        MatrixXd free(kStations, motion < 3 && motion != axis ? 2 : 1);
        free.col(0).setOnes();
        if (free.cols() == 2) free.col(1) = x;
        const MatrixXd Q = MatrixXd(free.householderQr().householderQ()).leftCols(free.cols());
        const MatrixXd left = (J - Q * (Q.transpose() * J)) / noise;
        const VectorXd right = (y - Q * (Q.transpose() * y)) / noise;
        campaign.seen.information.block(first, first, J.cols(), J.cols()) = left.transpose() * left;
        campaign.seen.vector.segment(first, J.cols()) = left.transpose() * right;
        first += J.cols();
      }
    }
    const double noise = kNoise * Mill().population.squareness;
    for (int i = 0; i < 3; ++i) {
      campaign.seen.information(first + i, first + i) = 1.0 / (noise * noise);
      campaign.seen.vector[first + i] =
          (drawn.squareness[i] + noise * random.Normal(at++)) / (noise * noise);
    }
    return campaign;
  }

  // The same machine, changed by a tenth of what another one is.
  Drawn Later(const Drawn& before, std::uint64_t seed) const {
    const Drawn other = Draw(seed);
    Drawn later = before;
    for (std::size_t f = 0; f < later.values.size(); ++f) later.values[f] += 0.1 * other.values[f];
    later.squareness += 0.1 * other.squareness;
    return later;
  }

 private:
  static VectorXd Stations(int axis) {
    const machine::Travel& travel = Mill().travels[axis];
    return VectorXd::LinSpaced(kStations, travel.first, travel.last);
  }
  static double Size(int axis, int motion) {
    static const fusion::PopulationEvidence evidence(Mill(), Model());
    for (const fusion::Knob& knob : evidence.knobs()) {
      if (knob.axis != axis || knob.motion != motion || knob.line == fusion::kSmoothness) continue;
      return kTrue[knob.line] * machine::PopulationDeviation(Mill().population, axis, motion);
    }
    throw std::logic_error("a function of no line");
  }
  static const machine::VolumetricModel& Model() {
    static const auto model = fusion::UnknownMachine(Mill(), fusion::KnotsOf(Mill()));
    return model;
  }

  machine::VolumetricModel model_;
};

std::string NameOf(int machine) { return "M" + std::to_string(machine); }

std::vector<Campaign> Campaigns(const Fleet& fleet) {
  std::vector<Campaign> campaigns;
  for (int m = 1; m <= kMachines; ++m) {
    campaigns.push_back(fleet.Measure(NameOf(m), "first", fleet.Draw(m), m));
  }
  return campaigns;
}

TEST(Fleet, TellsThePopulationOfItsMachines) {
  const Fleet fleet;
  const PopulationFit fit(Mill(), fleet.model(), Campaigns(fleet));
  ASSERT_EQ(fit.statements().size(), kTrue.size());
  for (std::size_t line = 0; line < kTrue.size(); ++line) {
    const fusion::Statement& said = fit.statements()[line];
    EXPECT_LT(std::abs(std::log(said.seen / said.stated / kTrue[line])), 3.0 * said.u_log)
        << said.key;
    const bool is_told = line != fusion::kScale;  // 20 ppm beside errors of 4 um
    EXPECT_TRUE(!is_told || said.u_log < 0.25) << said.key;
  }
  for (const OddError& odd : OddErrors(fit))
    EXPECT_FALSE(odd.is_certain()) << odd.machine << odd.error;
}

// A bow, a wave and a rounded kink, sizes spread evenly over a factor of five.
Drawn DrawOfNoProcess(const Fleet& fleet, std::uint64_t seed) {
  const random::CounterRandom random(seed, 0xB0E);
  std::uint64_t at = 0;
  Drawn drawn = fleet.Draw(seed);
  for (VectorXd& values : drawn.values) {
    const double size = std::sqrt(values.squaredNorm() / kStations);
    const double rate = 2.0 + 6.0 * random.Uniform(at++), phase = 6.3 * random.Uniform(at++);
    const double bow = random.Normal(at++), kink = random.Normal(at++),
                 where = random.Uniform(at++);
    const auto x = Eigen::ArrayXd::LinSpaced(kStations, 0.0, 1.0);
    values = (x * rate + phase).sin() + bow * (x - 0.5).square() * 4.0 +
             kink * ((x - where).square() + 0.04).sqrt() * 3.0;
    values.array() -= values.mean();
    values *=
        (0.3 + 1.3 * random.Uniform(at++)) * size / std::sqrt(values.squaredNorm() / kStations);
  }
  return drawn;
}

TEST(Fleet, AccusesNobodyInAFleetOfNoProcess) {
  const Fleet fleet;
  std::vector<Campaign> campaigns;
  for (int m = 1; m <= kMachines; ++m) {
    const Drawn drawn = DrawOfNoProcess(fleet, 100 + m);
    campaigns.push_back(fleet.Measure(NameOf(m), "first", drawn, m));
    if (m > 5) continue;
    campaigns.push_back(fleet.Measure(NameOf(m), "second", fleet.Later(drawn, 900 + m), 50 + m));
  }
  const PopulationFit fit(Mill(), fleet.model(), campaigns);
  for (const OddError& odd : OddErrors(fit)) EXPECT_FALSE(odd.is_certain()) << odd.error;
  EXPECT_TRUE(OddIdentities(fit, campaigns, {}).empty());
}

TEST(Fleet, NamesAnErrorThatNoOtherMachineHas) {
  const Fleet fleet;
  std::vector<Campaign> campaigns = Campaigns(fleet);
  Drawn odd = fleet.Draw(5);
  odd.values[6 * 1 + 3] *= 6.0;  // EAY
  campaigns[4] = fleet.Measure("M5", "first", odd, 5);
  const PopulationFit fit(Mill(), fleet.model(), campaigns);
  const auto errors = OddErrors(fit);
  ASSERT_FALSE(errors.empty());
  EXPECT_EQ(errors.front().machine, "M5");
  EXPECT_EQ(errors.front().error, "EAY");
  EXPECT_TRUE(errors.front().is_certain());
  EXPECT_GT(errors.front().times, 3.0);
  for (std::size_t i = 1; i < errors.size(); ++i) EXPECT_FALSE(errors[i].is_certain());
}

TEST(Fleet, NamesCampaignsOfSwappedIdentity) {
  const Fleet fleet;
  std::vector<Campaign> campaigns = Campaigns(fleet);
  const auto add = [&](int said, int real) {
    campaigns.push_back(fleet.Measure(NameOf(said), "second of " + NameOf(real),
                                      fleet.Later(fleet.Draw(real), 900 + real), 500 + real));
  };
  for (int m = 1; m <= 6; ++m) add(m, m);
  EXPECT_TRUE(
      OddIdentities(PopulationFit(Mill(), fleet.model(), campaigns), campaigns, {}).empty());
  add(11, 12);
  add(12, 11);
  add(13, 99);  // of none of the fleet's
  const PopulationFit fit(Mill(), fleet.model(), campaigns);
  std::vector<std::pair<std::string, std::string>> named;
  for (const OddIdentity& odd : OddIdentities(fit, campaigns, {})) {
    named.emplace_back(odd.said, odd.fits);
  }
  // Where two campaigns of a machine do not belong together, either may be the wrong one.
  EXPECT_THAT(named, testing::UnorderedElementsAreArray(
                         std::vector<std::pair<std::string, std::string>>{{"M11", "M12"},
                                                                          {"M11", "M12"},
                                                                          {"M12", "M11"},
                                                                          {"M12", "M11"},
                                                                          {"M13", ""},
                                                                          {"M13", ""}}));
}

TEST(Fleet, NeedsAMachine) {
  const Fleet fleet;
  EXPECT_THROW(PopulationFit(Mill(), fleet.model(), {}), InputError);
}

}  // namespace fleet_test
}  // namespace abbe::fleet
