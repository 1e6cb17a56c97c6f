// The levers of weights, against the height of the weight: torque about a joint is what its height
// loses by a turn of the joint (virtual work), whatever points of the axes are written.
#include "relm/weights.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <string>

#include "relm/error_models.h"
#include "relm/linkage_settings.h"
#include "settings/document.h"

namespace abbe::relm {
namespace weights_test {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kRight = 90.0;

// The rows that the maker of a small robot states, in m and deg.
SerialChain SmallRobot() {
  constexpr double kDegree = 3.14159265358979323846 / 180.0;
  const auto row = [](double theta, double d, double a, double alpha) {
    return DenavitHartenbergRow{kDegree * theta, d, a, kDegree * alpha};
  };
  return SerialChain::FromDenavitHartenberg(
      {row(0, 0.290, 0, -kRight), row(-kRight, 0, 0.270, 0), row(0, 0, 0.070, -kRight),
       row(0, 0.302, 0, kRight), row(0, 0, 0, -kRight), row(180, 0.072, 0, 0)},
      {}, Vector3d(0.0, -0.003, 0.124));
}

// The same lines with other points.
SerialChain Rewritten(const SerialChain& chain) {
  std::vector<JointAxis> axes = chain.axes();
  double along = 0.11;
  for (JointAxis& axis : axes) axis.point += (along *= -1.3) * axis.direction;
  return {axes, chain.tip()};
}

LinkageSettings SettingsOf(const SerialChain& chain) {
  const auto document = settings::Document::Parse(
      "[linkage]\nform = \"axes\"\nball_mm = [0, 0, 1]\n[[linkage.axis]]\npoint_mm = [0, 0, 0]\n"
      "direction = [1, 0, 0]\n[linkage.base]\nposition_mm = [0, 0, 0]\n",
      "arm.toml");
  LinkageSettings settings = ReadLinkageSettings(document.Root());
  settings.chain = chain;
  settings.tolerance.weight = 1e-3;
  return settings;
}

VectorXd AnyAngles() { return VectorXd{{0.4, -0.7, 0.5, 1.1, -0.8, 2.0}}; }

std::map<std::string, Vector3d> PointsBeyond(const SerialChain& chain, Index joint) {
  std::map<std::string, Vector3d> points;
  for (const Weight& weight : WeightsBeyond(chain, joint)) points[weight.name] = weight.point;
  return points;
}

TEST(Weights, HangWhereTheLinesOfTheJointsMeet) {
  const SerialChain robot = SmallRobot();
  const Vector3d wrist(0.302, 0.0, 0.630);
  const std::vector<std::map<std::string, Vector3d>> by_hand{
      {{"own", {0.0, 0.0, 0.290}}, {"wrist", wrist}, {"ball", robot.tip()}},
      {{"own", {0.0, 0.0, 0.560}}, {"wrist", wrist}, {"ball", robot.tip()}},
      {{"own", {0.0, 0.0, 0.630}}, {"wrist", wrist}, {"ball", robot.tip()}},
      {{"ball", robot.tip()}},
      {{"ball", robot.tip()}},
      {{"ball", robot.tip()}}};
  for (const SerialChain& chain : {robot, Rewritten(robot)}) {
    for (Index joint = 1; joint < 6; ++joint) {
      const auto found = PointsBeyond(chain, joint);
      const auto& expected = by_hand[static_cast<std::size_t>(joint)];
      ASSERT_EQ(found.size(), expected.size()) << joint;
      for (const auto& [name, point] : expected) {
        ASSERT_TRUE(found.contains(name)) << joint << name;
        // Where an axis is parallel to that of the joint, any point of it has the same lever.
        const Vector3d& axis = chain.axes()[static_cast<std::size_t>(joint)].direction;
        EXPECT_LT((found.at(name) - point).cross(axis).norm(), 1e-12) << joint << name;
      }
    }
  }
}

// What one unit of the parameter turns its joint by, from the derivatives of the tip.
double LeverIn(const LinkageModel& model, const TipDerivatives& at, Index joint,
               const std::string& name) {
  const std::vector<std::string> names = model.Names();
  const auto column = [&](const std::string& wanted) -> Vector3d {
    return at.J_tip_x.col(std::find(names.begin(), names.end(), wanted) - names.begin());
  };
  const std::string pivot = "pivot_" + std::to_string(joint + 1);
  const Vector3d turn = column("encoder_offset." + pivot);
  return column("weight." + pivot + "_" + name).dot(turn) / turn.squaredNorm();
}

TEST(Weights, TurnTheirJointByWhatTheirHeightLoses) {
  constexpr double kStep = 1e-5;
  for (const SerialChain& chain : {SmallRobot(), Rewritten(SmallRobot())}) {
    const LinkageModel model = CompleteErrorModel(SettingsOf(chain));
    const TipDerivatives at = model.Differentiate(AnyAngles(), 0.0, model.Values());
    for (Index joint = 1; joint < 6; ++joint) {
      for (const Weight& weight : WeightsBeyond(SmallRobot(), joint)) {
        std::vector<JointAxis> axes = SmallRobot().axes();
        axes.resize(static_cast<std::size_t>(weight.carrier) + 1);
        const SerialChain carrier(axes, weight.point);
        const auto height = [&](double turn) {
          VectorXd angles = AnyAngles();
          angles[joint] += turn;
          return carrier.Tip(VectorXd(angles.head(carrier.joints()))).z();
        };
        const double lever = (height(-kStep) - height(kStep)) / (2.0 * kStep);
        EXPECT_NEAR(LeverIn(model, at, joint, weight.name), lever, 1e-9) << joint << weight.name;
      }
    }
  }
}

// Virtual work: the torque of masses about a joint is what their potential energy loses by its turn.
TEST(Weights, KnownMassesActByTheirTorqueTogether) {
  constexpr double kStep = 1e-5, kGravity = 9.80665;
  LinkageSettings settings = SettingsOf(SmallRobot());
  settings.masses = {{4.0, 1, Vector3d(0.02, 0.01, 0.45)},
                     {2.5, 3, Vector3d(0.20, -0.03, 0.64)},
                     {1.5, 5, SmallRobot().tip()}};
  const LinkageModel model = CompleteErrorModel(settings);
  const TipDerivatives at = model.Differentiate(AnyAngles(), 0.0, model.Values());
  for (Index joint = 1; joint < 6; ++joint) {
    const auto energy = [&](double turn) {
      VectorXd angles = AnyAngles();
      angles[joint] += turn;
      double sum = 0.0;
      for (const Mass& mass : settings.masses) {
        if (mass.carrier < joint) continue;
        std::vector<JointAxis> axes = SmallRobot().axes();
        axes.resize(static_cast<std::size_t>(mass.carrier) + 1);
        const SerialChain carrier(axes, mass.point);
        sum += kGravity * mass.kg * carrier.Tip(VectorXd(angles.head(carrier.joints()))).z();
      }
      return sum;
    };
    const double torque = (energy(-kStep) - energy(kStep)) / (2.0 * kStep);
    EXPECT_NEAR(LeverIn(model, at, joint, "torque"), torque, 1e-7) << joint;
  }
  for (const std::string& name : model.Names()) {
    EXPECT_FALSE(name.starts_with("weight.") && !name.ends_with("_torque")) << name;
    EXPECT_FALSE(name.starts_with("weight.pivot_1")) << name;
  }
}

TEST(Weights, AnUprightFirstAxisFeelsNone) {
  for (const std::string& name : CompleteErrorModel(SettingsOf(SmallRobot())).Names()) {
    EXPECT_FALSE(name.starts_with("weight.pivot_1")) << name;
  }
}

TEST(Weights, TheTipFollowsTheAnglesAsDifferentiated) {
  constexpr double kStep = 1e-5;
  const LinkageModel model = CompleteErrorModel(SettingsOf(SmallRobot()));
  VectorXd x = model.Values();
  const std::vector<std::string> names = model.Names();
  for (Index i = 0; i < x.size(); ++i) {
    // Large, so that the slopes of the levers show.
    if (names[static_cast<std::size_t>(i)].starts_with("weight.")) x[i] = 0.05 + 0.01 * i;
  }
  const TipDerivatives at = model.Differentiate(AnyAngles(), 0.0, x);
  EXPECT_LT((at.tip - model.Tip(AnyAngles(), 0.0, x)).norm(), 1e-14);
  for (Index joint = 0; joint < 6; ++joint) {
    const VectorXd step = kStep * VectorXd::Unit(6, joint);
    const Vector3d slope =
        (model.Tip(AnyAngles() + step, 0.0, x) - model.Tip(AnyAngles() - step, 0.0, x)) /
        (2.0 * kStep);
    EXPECT_LT((at.J_tip_q.col(joint) - slope).norm(), 1e-9) << joint;
  }
}

}  // namespace weights_test
}  // namespace abbe::relm
