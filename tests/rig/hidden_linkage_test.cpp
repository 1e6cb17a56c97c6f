// Each hidden effect of the linkage against its closed form.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rig/dragged.h"
#include "tests/rig/hidden_worlds.h"

namespace abbe::rig {
namespace hidden_linkage_test {

using Eigen::Vector3d;

constexpr double kRounding = 1e-14;

Linkage LinkageWith(const std::vector<std::string>& hide) {
  return {PerfectLinkage(), 1, Hide(hide)};
}

// Link 1 of 120 mm along x, link 2 of 120 mm along z at zero angles.
const Vector3d kTurns(0.2, -0.6, 0.5);

TEST(HiddenLinkage, EccentricityComesOnceATurn) {
  const Linkage linkage =
      LinkageWith({"encoder-eccentricity:object=pivot_2:sin_urad=50:cos_urad=-20"});
  const Vector3d beside = linkage.EncodersAt(kTurns) - kTurns;
  EXPECT_NEAR(beside[1], 50e-6 * std::sin(-0.6) - 20e-6 * std::cos(-0.6), kRounding);
  EXPECT_EQ(beside[0], 0.0);
  EXPECT_EQ(beside[2], 0.0);
}

TEST(HiddenLinkage, SubdivisionComesWithItsOrder) {
  const Linkage linkage =
      LinkageWith({"encoder-subdivision:object=pivot_3:order=16:sin_urad=7:cos_urad=3"});
  EXPECT_NEAR(linkage.EncodersAt(kTurns)[2] - kTurns[2],
              7e-6 * std::sin(8.0) + 3e-6 * std::cos(8.0), kRounding);
}

TEST(HiddenLinkage, RoundnessLengthensTheLinkAfterThePivot) {
  const std::string sizes = ":sin2_um=3:cos2_um=1:sin3_um=-2:cos3_um=5";
  const auto longer = [](double turn) {
    return 3e-6 * std::sin(2.0 * turn) + 1e-6 * std::cos(2.0 * turn) - 2e-6 * std::sin(3.0 * turn) +
           5e-6 * std::cos(3.0 * turn);
  };
  const Linkage plain = LinkageWith({});
  const Vector3d ball = plain.BallAt(kTurns, 20.0);
  // Link 1 after two turns, link 2 after three.
  const Eigen::Matrix3d turned =
      (Eigen::AngleAxisd(0.2, Vector3d::UnitZ()) * Eigen::AngleAxisd(-0.6, Vector3d::UnitY()))
          .matrix();
  const Vector3d link_1 = turned * Vector3d::UnitX();
  const Vector3d link_2 = turned * Eigen::AngleAxisd(0.5, Vector3d::UnitY()) * Vector3d::UnitZ();
  for (int pivot = 0; pivot < kPivots; ++pivot) {
    const std::string object = "bearing-roundness:object=pivot_" + std::to_string(pivot + 1);
    const Vector3d moved = LinkageWith({object + sizes}).BallAt(kTurns, 20.0) - ball;
    const Vector3d expected = longer(kTurns[pivot]) * (pivot < 2 ? link_1 : link_2);
    EXPECT_LT((moved - expected).norm(), kRounding) << pivot;
  }
}

TEST(HiddenLinkage, ALinkGrowsMoreThanItShould) {
  const Linkage plain = LinkageWith({});
  const Linkage warm = LinkageWith({"link-thermal-growth:object=link_2:coefficient_ppm_per_c=5"});
  const Vector3d grown = warm.BallAt(Vector3d::Zero(), 23.0) - plain.BallAt(Vector3d::Zero(), 23.0);
  EXPECT_NEAR(grown.z(), 5e-6 * 3.0 * 0.12, kRounding);
  EXPECT_NEAR(grown.x(), 0.0, kRounding);
  EXPECT_LT((warm.BallAt(kTurns, 20.0) - plain.BallAt(kTurns, 20.0)).norm(), kRounding);
}

TEST(HiddenLinkage, AJointGivesUnderItsWeight) {
  const Linkage plain = LinkageWith({});
  const Linkage bent = LinkageWith({"link-gravity-bend:object=pivot_2:compliance_urad=100"});
  const Vector3d level = bent.BallAt(Vector3d::Zero(), 20.0) - plain.BallAt(Vector3d::Zero(), 20.0);
  // By the whole angle where link 1 is level: all after pivot 2 goes down by it; its square is
  // 1e-8.
  EXPECT_NEAR(level.z(), -100e-6 * 0.12, 2e-9);
  EXPECT_NEAR(level.x(), 100e-6 * 0.12, 2e-9);
  const Vector3d raised(0.0, -std::numbers::pi / 3.0, 0.0);  // 60 degrees above level
  const double moved = (bent.BallAt(raised, 20.0) - plain.BallAt(raised, 20.0)).norm();
  EXPECT_NEAR(moved, 0.5 * level.norm(), 2e-9);
}

TEST(HiddenLinkage, TheBallIsDraggedBehindTheCap) {
  DraggedBall ball(2.0);
  EXPECT_EQ(ball.Follow({0.0, 0.0, 0.0}), Vector3d::Zero().eval());
  for (int i = 1; i <= 10; ++i) ball.Follow({double(i), 0.0, 0.0});
  EXPECT_EQ(ball.Follow({10.0, 0.0, 0.0}), Vector3d(-2.0, 0.0, 0.0));
  EXPECT_EQ(ball.Follow({10.0, 0.0, 0.0}), Vector3d(-2.0, 0.0, 0.0));  // also while it stands
  EXPECT_EQ(ball.Follow({7.0, 0.0, 0.0}), Vector3d(1.0, 0.0, 0.0));    // and back over it
  EXPECT_EQ(ball.Follow({5.0, 0.0, 0.0}), Vector3d(2.0, 0.0, 0.0));
}

Course ThereAndBack() {
  const Vector3d from(0.01, 0.02, 0.03), to(0.03, 0.04, 0.05);
  return LineCourse({from, to, from}, 0.01, 0.3, 1);
}

recording::Recording Recorded(const HiddenEffects& hidden, CourseOptions options = {}) {
  return PerfectLinkageRig(hidden).Record(ThereAndBack(), options);
}

const char* const kColumns[] = {"pivot_1_rad", "pivot_2_rad", "pivot_3_rad"};

// The angles of a row if the ball stood at p_M.
Vector3d AnglesFor(const Linkage& linkage, const Vector3d& p_M, const Vector3d& near) {
  Vector3d angles = linkage.EncodersFor(p_M, 20.0);
  for (int i = 0; i < kPivots; ++i) {
    angles[i] = near[i] + std::remainder(angles[i] - near[i], 2.0 * std::numbers::pi);
  }
  return angles;
}

TEST(HiddenLinkage, FrictionInTheCapHoldsTheBallBack) {
  const auto path = Recorded(Hide({"cap-friction:object=cap:displacement_um=3"}));
  const Linkage plain = LinkageWith({});
  const Vector3d way = Vector3d(-1.0, -1.0, 1.0).normalized();  // of the tool on the table
  for (std::size_t i = 0; i < path.rows(); i += 7) {
    const double x = path.At("x_mm")[i];
    if (x < 10.1 || x > 29.9) continue;
    const Vector3d tool(-1e-3 * x, -1e-3 * path.At("y_mm")[i], 1e-3 * path.At("z_mm")[i]);
    Vector3d shown;
    for (int k = 0; k < kPivots; ++k) shown[k] = path.At(kColumns[k])[i];
    // direction is the sign of the motion along x.
    const Vector3d ball = tool - 3e-6 * path.At("direction")[i] * way;
    EXPECT_LT((AnglesFor(plain, ball, shown) - shown).norm(), 1e-11);
  }
}

TEST(HiddenLinkage, LateEncodersShowWhereTheAxesWere) {
  const auto path = Recorded(Hide({"clock-skew:object=linkage:delay_ms=5"}));
  const Linkage plain = LinkageWith({});
  const double speed = 0.01 / std::sqrt(3.0);
  for (std::size_t i = 0; i < path.rows(); i += 7) {
    const double x = path.At("x_mm")[i];
    if (x < 12.0 || x > 28.0) continue;  // at the full feed
    const Vector3d axes(x, path.At("y_mm")[i], path.At("z_mm")[i]);
    const Vector3d were = 1e-3 * axes - Vector3d::Constant(5e-3 * speed * path.At("direction")[i]);
    Vector3d shown;
    for (int k = 0; k < kPivots; ++k) shown[k] = path.At(kColumns[k])[i];
    const Vector3d angles = AnglesFor(plain, {-were.x(), -were.y(), were.z()}, shown);
    EXPECT_LT((angles - shown).norm(), 1e-9);
  }
}

TEST(HiddenLinkage, HysteresisLeadsByHalfAlongThePivotsOwnMotion) {
  const auto path = Recorded(Hide({"joint-hysteresis:object=pivot_1:width_urad=40"}));
  const auto plain = Recorded({});
  const auto shown = path.At("pivot_1_rad"), turn = plain.At("pivot_1_rad");
  double before = 0.0;
  for (std::size_t i = 1; i < shown.size(); ++i) {
    const double x = path.At("x_mm")[i];
    if (x < 11.0 || x > 29.0) continue;
    const double own = turn[i] > turn[i - 1] ? 1.0 : -1.0;
    EXPECT_NEAR(shown[i] - turn[i], own * 20e-6, 1e-10);
    before = std::min(before, own);
  }
  EXPECT_EQ(before, -1.0);  // it went both ways
}

TEST(HiddenLinkage, AnEncoderSlipsAndKeepsItsNewZero) {
  const auto path =
      Recorded(Hide({"encoder-count-slip:object=pivot_3:time_s=102:angle_urad=70",
                     "warm-up-drift:object=pivot_2:amplitude_urad=30:time_constant_s=200"}),
               {.begin = 100.0});
  const auto plain = Recorded({});
  for (std::size_t i = 0; i < path.rows(); ++i) {
    const double time = 100.0 + path.At("time_s")[i];
    EXPECT_NEAR(path.At("pivot_3_rad")[i] - plain.At("pivot_3_rad")[i], time >= 102.0 ? 70e-6 : 0.0,
                1e-11);
    EXPECT_NEAR(path.At("pivot_2_rad")[i] - plain.At("pivot_2_rad")[i],
                30e-6 * (1.0 - std::exp(-time / 200.0)), 1e-11);
  }
}

TEST(HiddenLinkage, ABumpAtOneAngleAndAWanderAreNoCauses) {
  const auto plain = Recorded({});
  const double centre = plain.At("pivot_1_rad")[plain.rows() / 4];
  const auto path =
      Recorded(Hide({"unknown-angle-bump:object=pivot_1:height_urad=50:width_rad=0.01:centre_rad=" +
                         fmt::format("{:.17g}", centre),
                     "unknown-wander:object=pivot_2:deviation_urad=20:time_constant_s=1"}));
  double most = 0.0, square = 0.0;
  for (std::size_t i = 0; i < path.rows(); ++i) {
    const double turn = plain.At("pivot_1_rad")[i], from = (turn - centre) / 0.01;
    const double bump = path.At("pivot_1_rad")[i] - turn;
    EXPECT_NEAR(bump, 50e-6 * std::exp(-0.5 * from * from), 1e-9);
    most = std::max(most, bump);
    const double wander = path.At("pivot_2_rad")[i] - plain.At("pivot_2_rad")[i];
    square += wander * wander / static_cast<double>(path.rows());
  }
  EXPECT_NEAR(most, 50e-6, 1e-6);
  // Some seven time constants: two or three independent numbers.
  EXPECT_GT(std::sqrt(square), 5e-6);
  EXPECT_LT(std::sqrt(square), 50e-6);
}

TEST(HiddenLinkage, AnEncoderCanJump) {
  HiddenEffects hidden = Hide({"outliers:object=pivot_2:count=5"});
  SetInTime(hidden, {{0.0, 6.0, false, true}});
  const auto path = Recorded(hidden), plain = Recorded({});
  int jumps = 0;
  for (std::size_t i = 0; i < path.rows(); ++i) {
    jumps += std::abs(path.At("pivot_2_rad")[i] - plain.At("pivot_2_rad")[i]) > 99e-6 ? 1 : 0;
  }
  EXPECT_EQ(jumps, 5);
}

}  // namespace hidden_linkage_test
}  // namespace abbe::rig
