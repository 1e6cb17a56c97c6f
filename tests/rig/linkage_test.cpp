#include "rig/linkage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "failure/failure.h"
#include "relm/pivot_linkage.h"
#include "tests/relm/linkage_by_matrices.h"
#include "tests/rig/demo_rig.h"

namespace abbe::rig {
namespace linkage_test {

using Eigen::Vector3d;
using relm::MoveBy;
using relm::TurnY;
using relm::TurnZ;
using Matrix4 = relm::Matrix4<double>;

constexpr double kReference = 20.0;  // degC
// A dozen products of lengths of 0.3 m: 1e-16 each.
constexpr double kRounding = 1e-15;
constexpr double kClosed = 1e-13;  // m, as rig/linkage.h says
const Vector3d kTurns(0.3, -0.7, 0.5);

// Links of unequal length, so that no term hides behind another; nothing is drawn.
LinkageSettings Perfect() {
  LinkageSettings settings = ReadLinkage(DemoMill().Root());
  settings.link_1 = 0.130;
  settings.link_2 = 0.110;
  for (double* deviation :
       {&settings.link, &settings.pivot_angle, &settings.pivot_offset, &settings.encoder_offset,
        &settings.eccentricity, &settings.graduation, &settings.bearing, &settings.base_place,
        &settings.base_angle, &settings.ball, &settings.compliance, &settings.thermal}) {
    *deviation = 0.0;
  }
  return settings;
}

Linkage With(double LinkageSettings::*deviation, double value, std::uint64_t seed = 3) {
  LinkageSettings settings = Perfect();
  settings.*deviation = value;
  return {settings, seed};
}

// The closed form of the RELM paper.
Vector3d ClosedForm(const Vector3d& q, double link_1 = 0.130, double link_2 = 0.110) {
  const double reach = link_1 * std::cos(q[1]) + link_2 * std::sin(q[1] + q[2]);
  return {std::cos(q[0]) * reach, std::sin(q[0]) * reach,
          -link_1 * std::sin(q[1]) + link_2 * std::cos(q[1] + q[2])};
}

std::vector<Vector3d> Postures() {
  std::vector<Vector3d> postures;
  for (const double a : {-1.1, 0.0, 0.4}) {
    for (const double b : {-0.9, -0.2}) {
      for (const double c : {-0.3, 0.2, 0.9}) postures.emplace_back(a, b, c);
    }
  }
  return postures;
}

double Distance(const Vector3d& a, const Vector3d& b) { return (a - b).norm(); }

TEST(RigLinkage, WithoutErrorsIsTheClosedFormOfThePaper) {
  const Linkage linkage(Perfect(), 1);
  for (const Vector3d& q : Postures()) {
    EXPECT_LT(Distance(linkage.BallAt(q, kReference), ClosedForm(q)), kRounding);
    EXPECT_EQ(linkage.EncodersAt(q), q);
  }
}

// On every branch, by relm's inverse.
TEST(RigLinkage, WithoutErrorsItsAnglesGiveTheCommandedTipBack) {
  for (const bool up : {true, false}) {
    for (const bool over : {true, false}) {
      LinkageSettings settings = Perfect();
      settings.elbow_up = up;
      settings.reach_over = over;
      const Linkage linkage(settings, 1);
      const relm::PivotLinkage closed(0.130, 0.110);
      for (const Vector3d& p_M : {Vector3d(0.0, 0.0, 0.0), Vector3d(-0.06, -0.03, 0.05)}) {
        const Vector3d q = linkage.EncodersFor(p_M, kReference);
        EXPECT_LT(Distance(closed.Tip(q) + settings.base_position, p_M), kClosed + kRounding);
        const Vector3d expected = closed.Angles(p_M - settings.base_position,
                                                {up ? relm::Elbow::kUp : relm::Elbow::kDown, over});
        // kClosed over the shorter link, and the elbow's leverage.
        EXPECT_LT((relm::Unwrapped(q, expected) - expected).norm(), 10.0 * kClosed / 0.110)
            << up << over;
      }
    }
  }
}

TEST(RigLinkage, ClosesTheLoopOfEveryDrawnLinkage) {
  const LinkageSettings settings = ReadLinkage(DemoMill().Root());
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const Linkage linkage(settings, seed);
    for (const Vector3d& p_B : {Vector3d(0.18, 0.03, 0.03), Vector3d(0.13, -0.03, 0.08)}) {
      EXPECT_LT(Distance(linkage.BallAt(linkage.TurnsFor(p_B, 23.0), 23.0), p_B), kClosed);
    }
  }
}

TEST(RigLinkage, RefusesAPlaceOutOfReach) {
  const Linkage linkage(Perfect(), 1);
  EXPECT_THROW(linkage.TurnsFor({0.25, 0.0, 0.0}, kReference), InputError);
  EXPECT_THROW(linkage.TurnsFor({0.01, 0.0, 0.0}, kReference), InputError);
}

// A turn about a line, as a product of 4 x 4 matrices: to the line, upright, and back.
Matrix4 TurnAboutLine(const Vector3d& point, const Vector3d& direction, double angle) {
  const double lean = std::acos(direction.z());
  const double towards = std::atan2(direction.y(), direction.x());
  return MoveBy(point.x(), point.y(), point.z()) * TurnZ(towards) * TurnY(lean) * TurnZ(angle) *
         TurnY(-lean) * TurnZ(-towards) * MoveBy(-point.x(), -point.y(), -point.z());
}

Vector3d BallByMatrices(const Linkage& linkage, const Vector3d& turns) {
  Matrix4 moved = Matrix4::Identity();
  for (std::size_t i = 0; i < kPivots; ++i) {
    const PivotTruth& pivot = linkage.pivots()[i];
    Vector3d shift = Vector3d::Zero();
    for (std::size_t k = 0; k < 2; ++k) {
      for (const Harmonic& h : pivot.run_out[k]) {
        const double phase = h.order * turns[static_cast<Eigen::Index>(i)];
        shift += (h.sine * std::sin(phase) + h.cosine * std::cos(phase)) * pivot.across[k];
      }
    }
    moved *= MoveBy(shift.x(), shift.y(), shift.z()) *
             TurnAboutLine(pivot.point, pivot.direction, turns[static_cast<Eigen::Index>(i)]);
  }
  return (moved * linkage.ball().homogeneous()).head<3>();
}

TEST(RigLinkage, GeometryAndBearingsAreThoseOfMatricesWrittenOut) {
  LinkageSettings settings = ReadLinkage(DemoMill().Root());
  settings.compliance = 0.0;
  const Linkage linkage(settings, 9);
  for (const Vector3d& q : Postures()) {
    // The angle of a direction near z by its cosine: sqrt(2 eps) lost of it, times its change.
    EXPECT_LT(Distance(linkage.BallAt(q, kReference), BallByMatrices(linkage, q)), 2e-11);
  }
}

// A pivot keeps the ball on a circle about its axis: distance from it and height along it stay.
TEST(RigLinkage, ATiltedPivotTurnsTheBallAboutItsOwnAxis) {
  LinkageSettings settings = Perfect();
  settings.pivot_angle = 5e-4;
  settings.pivot_offset = 2e-5;
  const Linkage linkage(settings, 5);
  const PivotTruth& pivot = linkage.pivots()[0];
  EXPECT_GT((pivot.direction - Vector3d::UnitZ()).norm(), 1e-4);
  const auto from = [&](double turn) {
    return Vector3d(linkage.BallAt({turn, -0.7, 0.5}, kReference) - pivot.point);
  };
  for (const double turn : {-2.0, 0.5, 3.0}) {
    EXPECT_NEAR(from(turn).dot(pivot.direction), from(0.0).dot(pivot.direction), kRounding);
    EXPECT_NEAR(from(turn).cross(pivot.direction).norm(), from(0.0).cross(pivot.direction).norm(),
                kRounding);
  }
}

// Link 2 is mounted on pivot 3 and stays square to it however it was built; the same for link 1.
TEST(RigLinkage, APivotBuiltAskewCarriesWhatIsMountedOnIt) {
  const Linkage linkage = With(&LinkageSettings::pivot_angle, 5e-4);
  const PivotTruth &second = linkage.pivots()[1], &third = linkage.pivots()[2];
  const Vector3d link_1 = third.point - second.point, link_2 = linkage.ball() - third.point;
  EXPECT_NEAR(link_1.norm(), 0.130, kRounding);
  EXPECT_NEAR(link_2.norm(), 0.110, kRounding);
  EXPECT_NEAR(link_1.dot(second.direction), 0.0, kRounding);
  EXPECT_NEAR(link_2.dot(third.direction), 0.0, kRounding);
  EXPECT_GT(Distance(linkage.ball(), {0.130, 0.0, 0.110}), 1e-5);
}

TEST(RigLinkage, LinksAreLongerByWhatIsDrawn) {
  const Linkage linkage = With(&LinkageSettings::link, 1e-4);
  const double link_1 = linkage.ball().x(), link_2 = linkage.ball().z();
  EXPECT_NE(link_1, 0.130);
  EXPECT_LT(Distance(linkage.BallAt(kTurns, kReference), ClosedForm(kTurns, link_1, link_2)),
            kRounding);
}

TEST(RigLinkage, LinksGrowWithTheTemperature) {
  const Linkage linkage = With(&LinkageSettings::thermal, 1e-6);
  const double warm = 1.0 + 5.0 * linkage.expansion()[0];
  const double warm_2 = 1.0 + 5.0 * linkage.expansion()[1];
  EXPECT_NE(warm, warm_2);
  EXPECT_LT(Distance(linkage.BallAt(kTurns, kReference + 5.0),
                     ClosedForm(kTurns, 0.130 * warm, 0.110 * warm_2)),
            kRounding);
}

TEST(RigLinkage, TheBaseMovesWhatTheLinkageSees) {
  LinkageSettings settings = Perfect();
  settings.base_place = 5e-4;
  settings.base_angle = 2e-3;
  const Linkage linkage(settings, 4), perfect(Perfect(), 4);
  const Vector3d p_B(0.15, 0.02, 0.05);
  const Vector3d expected = perfect.EncodersFor(p_B + settings.base_position, kReference);
  const Vector3d p_M = linkage.base() * p_B;
  EXPECT_GT(Distance(p_M, p_B + settings.base_position), 1e-4);
  EXPECT_LT((linkage.EncodersFor(p_M, kReference) - expected).norm(), 10.0 * kClosed / 0.110);
}

// The sum of f(q) times the wave over a turn picks one harmonic, exactly.
template <typename Function>
std::pair<double, double> HarmonicOf(const Function& f, int order) {
  constexpr int kSamples = 32;
  double sine = 0.0, cosine = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const double q = 2.0 * std::numbers::pi * i / kSamples;
    sine += 2.0 / kSamples * f(q) * std::sin(order * q);
    cosine += 2.0 / kSamples * f(q) * std::cos(order * q);
  }
  return {sine, cosine};
}

// Pivot 3 alone turns: the run-out shifts the ball along the two directions across its axis, with
// the two harmonics, and not along the axis.
TEST(RigLinkage, BearingsRunOutAcrossTheAxisWithTheirHarmonics) {
  const Linkage linkage = With(&LinkageSettings::bearing, 1e-6);
  const auto shift = [&](double q, const Vector3d& along) {
    const Vector3d turns(0.0, 0.0, q);
    return (linkage.BallAt(turns, kReference) - ClosedForm(turns)).dot(along);
  };
  const PivotTruth& pivot = linkage.pivots()[2];
  for (std::size_t k = 0; k < 2; ++k) {
    const auto along = [&](double q) { return shift(q, pivot.across[k]); };
    for (const Harmonic& h : pivot.run_out[k]) {
      EXPECT_NEAR(HarmonicOf(along, h.order).first, h.sine, kRounding);
      EXPECT_NEAR(HarmonicOf(along, h.order).second, h.cosine, kRounding);
      EXPECT_GT(std::hypot(h.sine, h.cosine), 1e-8);
    }
    EXPECT_NEAR(HarmonicOf(along, 3).first, 0.0, kRounding);
  }
  EXPECT_NEAR(HarmonicOf([&](double q) { return shift(q, Vector3d::UnitY()); }, 1).first, 0.0,
              kRounding);
}

TEST(RigLinkage, EncodersHaveAZeroAnEccentricityAndAGraduation) {
  LinkageSettings settings = Perfect();
  settings.encoder_offset = 1e-3;
  settings.eccentricity = 2e-5;
  settings.graduation = 3e-6;
  const Linkage linkage(settings, 6);
  for (Eigen::Index i = 0; i < kPivots; ++i) {
    const PivotTruth& pivot = linkage.pivots()[static_cast<std::size_t>(i)];
    const auto error = [&](double q) { return linkage.EncodersAt(Vector3d::Constant(q))[i] - q; };
    EXPECT_NEAR(HarmonicOf(error, 0).second / 2.0, pivot.encoder_zero, kRounding * 10.0);
    ASSERT_EQ(pivot.encoder.size(), 3U);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(pivot.encoder[k].order, static_cast<int>(k) + 1);
      const auto [sine, cosine] = HarmonicOf(error, static_cast<int>(k) + 1);
      EXPECT_NEAR(sine, pivot.encoder[k].sine, kRounding * 10.0);
      EXPECT_NEAR(cosine, pivot.encoder[k].cosine, kRounding * 10.0);
    }
  }
}

// Each link turns about its pivot by `give` times the share of its weight that acts across it.
TEST(RigLinkage, GravityTurnsALinkByWhatItsPivotGivesWhereItIsHorizontal) {
  const Linkage linkage = With(&LinkageSettings::compliance, 2e-5);
  const double give_2 = linkage.pivots()[1].give, give_3 = linkage.pivots()[2].give;
  const double lowered_2 = kTurns[1] + give_2 * std::cos(kTurns[1]);
  const double lowered_3 = kTurns[2] + give_3 * std::sin(lowered_2 + kTurns[2]);
  EXPECT_LT(
      Distance(linkage.BallAt(kTurns, kReference), ClosedForm({kTurns[0], lowered_2, lowered_3})),
      kRounding);
  // Both links upright: nothing gives.
  const Vector3d upright(0.0, -std::numbers::pi / 2.0, std::numbers::pi / 2.0);
  EXPECT_LT(Distance(linkage.BallAt(upright, kReference), ClosedForm(upright)), kRounding);
}

TEST(RigLinkage, DrawsWithTheTolerancesOfTheMachineFile) {
  const LinkageSettings settings = ReadLinkage(DemoMill().Root());
  constexpr int kSeeds = 400;
  double link = 0.0, zero = 0.0, lean = 0.0, base = 0.0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const Linkage drawn(settings, static_cast<std::uint64_t>(seed));
    const PivotTruth& pivot = drawn.pivots()[1];
    zero += std::pow(pivot.encoder_zero / settings.encoder_offset, 2);
    lean += std::pow(pivot.direction.x() / settings.pivot_angle, 2);
    base +=
        std::pow((drawn.base().translation - settings.base_position).y() / settings.base_place, 2);
    const double link_2 = (drawn.ball() - drawn.pivots()[2].point).norm();
    link += std::pow((link_2 - settings.link_2) / settings.link, 2);
  }
  // Four standard deviations of a mean of squares.
  const double noise = 4.0 * std::sqrt(2.0 / kSeeds);
  for (const double sum : {zero, lean, base, link}) EXPECT_NEAR(sum / kSeeds, 1.0, noise);
}

TEST(RigLinkage, RefusesALinkageThatItCannotBuild) {
  for (const char* text : {"[linkage]\nform = \"axes\"\n[linkage.base]\nposition_mm = [0, 0, 0]\n",
                           "[linkage]\n[linkage.base]\nposition_mm = [0, 0, 0]\n"
                           "rotation = [\"x\", \"z\", \"y\"]\n",
                           "[linkage]\ndown = \"w\"\n[linkage.base]\nposition_mm = [0, 0, 0]\n"}) {
    const auto document = settings::Document::Parse(text, "linkage.toml");
    EXPECT_THROW(ReadLinkage(document.Root()), InputError) << text;
  }
}

}  // namespace linkage_test
}  // namespace abbe::rig
