// A ballbar against closed forms: circles seen from a ball beside their centre, the two lobes of a
// squareness, the scatter of neighbouring readings, times from the feed.
#include "recording/ballbar.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "../folders.h"
#include "failure/failure.h"
#include "fusion/machine_prior.h"
#include "machine/machine.h"
#include "random/counter_random.h"
#include "settings/document.h"
#include "simulation/ballbar/ballbar_simulation.h"

namespace abbe::simulation {
namespace ballbar_test {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::VectorXd;
using recording::Recording;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kRadius = 0.025;          // m
const Vector3d kCentre(0.03, 0.03, 0.03);  // m
const char* const kCentreLine = "centre_mm = [30.0, 30.0, 30.0]\n";

// Both senses, a reading a degree; `radius` of the angle, m.
template <typename Radius>
Recording CircleOf(const Radius& radius, const std::string& header = kCentreLine) {
  Recording circle;
  circle.name = "xy.csv";
  circle.header = "kind = \"ballbar\"\naxis = \"XY\"\n" + header;
  circle.columns = {{"x_mm", {}}, {"y_mm", {}}, {"pass", {}}, {"ref_radius_mm", {}}};
  for (int i = 0; i < 720; ++i) {
    const double t = (i < 360 ? i : 719 - i) * std::numbers::pi / 180.0;
    const double row[] = {1e3 * kRadius * std::cos(t), 1e3 * kRadius * std::sin(t),
                          i < 360 ? 1.0 : 2.0, 1e3 * radius(t)};
    for (int k = 0; k < 4; ++k) circle.columns[k].values.push_back(row[k]);
  }
  return circle;
}

class Ballbar : public testing::Test {
 protected:
  const machine::Machine mill =
      machine::ReadMachine(settings::Document::Read(DemoMillFile()).Root());
  const machine::VolumetricModel model = fusion::UnknownMachine(mill);

  VectorXd Residual(const Recording& recording, const VectorXd& x) const {
    const SimulatedRun run = SimulateBallbar(model, mill.reference, ReadBallbarRun(recording));
    VectorXd values(run.residual->Rows());
    run.residual->Evaluate(x, values, nullptr);
    return values;
  }
  VectorXd Zeros() const { return VectorXd::Zero(4 + model.ParameterCount()); }
};

TEST_F(Ballbar, OfAPerfectMachineIsACircleSeenFromBesideItsCentre) {
  const Vector3d ball(40e-6, -70e-6, 150e-6);  // in axis coordinates
  constexpr double kLonger = 12e-6;
  const Recording circle = CircleOf(
      [&](double t) {
        return (kRadius * Vector3d(std::cos(t), std::sin(t), 0.0) - ball).norm() + kLonger;
      },
      std::string(kCentreLine) + "u_radius_um = 0.1\n");
  VectorXd x = Zeros();
  x.head<3>() = mill.chain.ToolSenses().cwiseProduct(ball);
  x[3] = kLonger;
  EXPECT_LT(Residual(circle, x).cwiseAbs().maxCoeff(), 1e-7);
  EXPECT_GT(Residual(circle, Zeros()).cwiseAbs().maxCoeff(), 100.0);
}

// An angle between the axes that is more than a right one by g makes -(R/2) g sin 2t of the radius
// (docs/circle.md, as ISO 230-4 has it). C0Y > 0: the axes enclose more than a right angle.
TEST_F(Ballbar, SeesASquarenessAsTwoLobes) {
  constexpr double kG = 80e-6;
  const Recording circle =
      CircleOf([](double t) { return kRadius - 0.5 * kRadius * kG * std::sin(2.0 * t); },
               std::string(kCentreLine) + "u_radius_um = 0.1\n");
  const SimulatedRun run = SimulateBallbar(model, mill.reference, ReadBallbarRun(circle));
  Index at = 0;
  for (const auto& block : run.blocks) {
    for (std::size_t i = 0; i < block.entries.size(); ++i, ++at) {
      if (block.FullName(i) != "squareness.C0Y") continue;
      // A turn about the centre of the circle's travel moves the circle too: fit the centre.
      VectorXd x = Zeros();
      x[at] = kG;
      VectorXd values(run.residual->Rows());
      estimation::RowMatrix J(values.size(), x.size());
      for (int round = 0; round < 3; ++round) {
        run.residual->Evaluate(x, values, &J);
        x.head<2>() -= Eigen::MatrixXd(J.leftCols<2>()).colPivHouseholderQr().solve(values);
      }
      run.residual->Evaluate(x, values, nullptr);
      EXPECT_LT(1e-7 * values.cwiseAbs().maxCoeff(), 1e-9);  // m; of 1 um, second order left
      return;
    }
  }
  FAIL() << "no squareness";
}

TEST_F(Ballbar, TakesItsNoiseFromTheScatterOfNeighbours) {
  constexpr double kSd = 0.2e-6;
  const random::CounterRandom random(7, 1);
  std::uint64_t row = 0;
  const auto noisy = [&](double t) {
    // A spike after a quadrant is no noise.
    const double spike = t > 1.58 && t < 1.66 ? 5e-6 : 0.0;
    return kRadius + 20e-6 * std::cos(2.0 * t) + spike + kSd * random.Normal(row++);
  };
  const BallbarRun run = ReadBallbarRun(CircleOf(noisy));
  EXPECT_FALSE(run.states_noise);
  EXPECT_NEAR(run.sd, kSd, 0.1 * kSd);
  EXPECT_EQ(ReadBallbarRun(CircleOf(noisy), 1e-6).sd, 1e-6);
}

// A table of a filtered signal: smooth to a nanometre, which no instrument is.
TEST_F(Ballbar, IsNoQuieterThanBallbarsAre) {
  const random::CounterRandom random(8, 1);
  std::uint64_t row = 0;
  const auto smooth = [&](double t) {
    return kRadius + 2e-6 * std::cos(2.0 * t) + 1e-9 * random.Normal(row++);
  };
  EXPECT_EQ(ReadBallbarRun(CircleOf(smooth)).sd, kFinestBallbarNoise);
  const auto stated = std::string(kCentreLine) + "u_radius_um = 0.001\n";
  EXPECT_NEAR(ReadBallbarRun(CircleOf(smooth, stated)).sd, 1e-9, 1e-15);
}

TEST_F(Ballbar, KnowsItsTimesFromTheFeed) {
  Recording circle = CircleOf([](double t) { return kRadius + 1e-7 * std::sin(50.0 * t); });
  circle.columns.push_back({"feed_mm_min", std::vector<double>(circle.rows(), 600.0)});
  const BallbarRun run = ReadBallbarRun(circle);
  EXPECT_FALSE(run.times_known);
  const double quarter = 0.5 * std::numbers::pi * 25.0 / 10.0;  // s at 10 mm/s
  // The first three rows: X has gone 15 um, Y some 0.9 mm.
  ASSERT_EQ(run.points.rows[0], 3u);
  EXPECT_NEAR(run.time[87], quarter, 1e-4 * quarter);
  EXPECT_EQ(run.rows(), 720 - 5);  // the second pass begins half a step from there
}

TEST_F(Ballbar, RefusesWhatItCannotPlace) {
  const auto circle = [](double) { return kRadius; };
  EXPECT_THAT([&] { ReadBallbarRun(CircleOf(circle, "")); },
              ThrowsMessage<InputError>(HasSubstr("xy.csv: does not say where on the machine")));
  EXPECT_THAT([&] { ReadBallbarRun(CircleOf(circle)); },
              ThrowsMessage<InputError>(HasSubstr("state u_radius_um in the header")));
  EXPECT_THAT(
      [&] { ReadBallbarRun(CircleOf(circle, std::string(kCentreLine) + "u_radius_um = 0\n")); },
      ThrowsMessage<InputError>(HasSubstr("u_radius_um must be above 0")));
  EXPECT_THAT([&] { ReadBallbarRun(CircleOf([](double t) { return t == 0.0 ? 0.0 : kRadius; })); },
              ThrowsMessage<InputError>(HasSubstr("row 1: a radius of 0 mm")));
}

TEST_F(Ballbar, OfOneNameHasOneLength) {
  const auto named = [&](const std::string& name) {
    return CircleOf([](double) { return kRadius; },
                    std::string(kCentreLine) + "u_radius_um = 0.1\nu_length_um = 0.5\n" + name);
  };
  const auto length = [&](const Recording& recording) {
    return SimulateBallbar(model, mill.reference, ReadBallbarRun(recording)).blocks[1];
  };
  EXPECT_EQ(length(named("[mounting]\nballbar = \"QC 7\"\n")).name, "ballbar_length QC 7");
  EXPECT_EQ(length(named("")).name, "ballbar_length xy.csv");
  EXPECT_EQ(length(named("")).entries[0].prior_sd, 0.5e-6);
}

}  // namespace ballbar_test
}  // namespace abbe::simulation
