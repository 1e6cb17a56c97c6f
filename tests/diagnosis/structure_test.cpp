// Functions of recorded variables in a trace made by hand: closed forms.
#include "diagnosis/structure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "simulation/variables.h"

namespace abbe::diagnosis {
namespace structure_test {

using Eigen::Index;
using Eigen::RowVectorXd;
using Eigen::VectorXd;
using simulation::ChannelsOf;
using simulation::Trace;
using simulation::UnitOf;
using simulation::ValuesOf;
using simulation::VariablesOf;

constexpr Index kRows = 401;

// X to and fro about its middle within an hour, Y and Z stand; the gap of probe a follows X.
Trace ToAndFro() {
  Trace trace;
  trace.time = trace.clock = VectorXd::LinSpaced(kRows, 0.0, 3600.0);
  const RowVectorXd turn = 2.0 * M_PI / 3600.0 * trace.time.transpose();
  trace.axes = trace.velocity = trace.acceleration = trace.heading =
      Eigen::Matrix3Xd::Zero(3, kRows);
  trace.since_reversal = Eigen::Matrix3Xd::Constant(3, kRows, simulation::kLongAgo);
  trace.axes.row(0) = 0.03 * turn.array().sin();
  trace.velocity.row(0) = 0.03 * 2.0 * M_PI / 3600.0 * turn.array().cos();
  trace.heading.row(0) = trace.velocity.row(0).array().sign();
  trace.head.emplace();
  trace.head->gap = Eigen::MatrixXd::Constant(5, kRows, 1e-4);
  trace.head->gap.row(0) = RowVectorXd::LinSpaced(kRows, 0.8e-4, 1.2e-4);
  trace.sensors = {"temp_table_c"};
  trace.temperature = 20.0 + 0.5 / 3600.0 * trace.time.transpose().array();
  trace.others = {"load_n"};
  trace.other = RowVectorXd::LinSpaced(kRows, 0.0, 400.0);
  return trace;
}

class Structures : public ::testing::Test {
 protected:
  Structures() : trace_(ToAndFro()) {
    scene_.traces = {&trace_};
    scene_.travel = {0.06, 0.06, 0.06};
  }

  StageChannel ChannelNamed(const std::string& name) const {
    const auto all = ChannelsOf(scene_);
    const auto found = std::ranges::find(all, name, &StageChannel::object);
    EXPECT_NE(found, all.end()) << name;
    return *found;
  }

  Eigen::MatrixXd Functions(const std::string& channel, const std::string& variable) const {
    const StageChannel of = ChannelNamed(channel);
    const auto range = RangeOf(variable, of, scene_);
    return range ? SmoothIn(of, variable, *range).FunctionsOf(trace_) : Eigen::MatrixXd{};
  }

  Trace trace_;
  simulation::Scene scene_;
};

// How much of `function` the functions can make, at best: 1 all of it.
double Share(const Eigen::MatrixXd& functions, const RowVectorXd& function) {
  const Eigen::MatrixXd columns = functions.transpose();
  const VectorXd values = function.transpose();
  const VectorXd fit = columns.colPivHouseholderQr().solve(values);
  return (fit.transpose() * functions).squaredNorm() / function.squaredNorm();
}

TEST_F(Structures, AreAskedOfEveryMotionOfEveryAxis) {
  std::vector<std::string> names;
  for (const StageChannel& channel : ChannelsOf(scene_)) names.push_back(channel.object);
  EXPECT_THAT(names, ::testing::IsSupersetOf({"probe_a", "probe_e", "X", "EYX", "EZX", "EAX", "EBX",
                                              "ECX", "EXY", "Y", "ECY", "EXZ", "EAZ", "Z"}));
  EXPECT_EQ(ChannelNamed("ECX").stage, simulation::MotionStage(0, 5));
  EXPECT_EQ(ChannelNamed("ECX").unit.name, "urad");
}

TEST_F(Structures, OfAYawThatJumpsWithTheDirectionAreThere) {
  EXPECT_NEAR(Share(Functions("ECX", "direction of x"), trace_.heading.row(0)), 1.0, 1e-12);
  EXPECT_LT(Share(Functions("X", "direction of x"), trace_.heading.row(0)), 0.9)
      << "lost motion that is the same everywhere is a cause";
}

TEST_F(Structures, OfItsOwnSpeedLeaveALagToTheCause) {
  const RowVectorXd speed = trace_.velocity.row(0);
  EXPECT_LT(Share(Functions("X", "speed of x"), speed), 1e-3);
  EXPECT_GT(Share(Functions("ECX", "speed of x"), speed), 0.99);
  // The cosines have no constant: a run explains it.
  Eigen::MatrixXd even = Functions("X", "speed of x");
  even.conservativeResize(even.rows() + 1, Eigen::NoChange);
  even.bottomRows<1>().setOnes();
  // The square, all but what eight cosines leave of a parabola.
  EXPECT_GT(Share(even, speed.array().square()), 0.999);
}

TEST_F(Structures, OfItsOwnGapLeaveGainAndSquareToTheCauses) {
  const Eigen::ArrayXd gap = (trace_.head->gap.row(0).transpose().array() - 1e-4) / 2e-5;
  const Eigen::MatrixXd functions = Functions("probe_a", "gap of probe_a");
  // Legendre polynomials are orthogonal to lower powers, but for the ends of so many rows.
  constexpr double kEnds = 2.0 / static_cast<double>(kRows);
  EXPECT_LT(Share(functions, gap.transpose()), kEnds);
  EXPECT_LT(Share(functions, (gap.square() - 1.0 / 3.0).transpose()), kEnds);
  EXPECT_NEAR(Share(functions, (gap.cube() - 0.6 * gap).transpose()), 1.0, 1e-9);
  EXPECT_EQ(Functions("probe_b", "gap of probe_a").size(), 0);
}

TEST_F(Structures, KnowTheRateOfATemperatureAndColumnsOfTheUser) {
  EXPECT_TRUE(ValuesOf("rate of temp_table_c", trace_)
                  .isApprox(RowVectorXd::Constant(kRows, 0.5 / 3600.0), 1e-9));
  EXPECT_EQ(UnitOf("rate of temp_table_c").name, "K/h");
  EXPECT_EQ(ValuesOf("column load_n", trace_), trace_.other.row(0));
  EXPECT_THAT(VariablesOf(scene_),
              ::testing::IsSupersetOf({"run", "column load_n", "rate of temp_table_c"}));
  EXPECT_EQ(Functions("X", "run").size(), 0) << "there is only one";
}

}  // namespace structure_test
}  // namespace abbe::diagnosis
