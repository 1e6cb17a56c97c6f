#include "probes/head_inversion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "failure/failure.h"
#include "probes/installation.h"

namespace abbe::probes {
namespace head_inversion_test {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Equations 8 to 12 of the source, derived again (docs/theory-head.md), on readings of no special
// form.
TEST(SimplifiedInversion, IsThePublishedOneForTheNominalLayout) {
  constexpr double l = 10e-3, h = 20e-3, d = 37e-3;
  const auto [a, b, c, s, t] = PerProbe<>{13e-6, -7e-6, 5e-6, 11e-6, -3e-6};
  const HeadErrors<> e =
      SimplifiedInversion(NominalLayout(), MovingBody::kTarget)({a, b, c, s, t}, d);
  const double eax = (b - c) / (2 * l), ebx = ((b + c) / 2 - a) / l, ecx = (t - s) / l;
  constexpr double kRounding = 1e-17;  // of angles near 1e-3 rad
  EXPECT_NEAR(e.eax, eax, kRounding);
  EXPECT_NEAR(e.ebx, ebx, kRounding);
  EXPECT_NEAR(e.ecx, ecx, kRounding);
  EXPECT_NEAR(e.ezx, (b + c) / 2 - d * ebx, kRounding);
  EXPECT_NEAR(e.eyx, s + h * eax + d * ecx, kRounding);
}

TEST(SimplifiedInversion, OfAMovingHeadHasNoLever) {
  constexpr double l = 10e-3, h = 20e-3;
  const auto [a, b, c, s, t] = PerProbe<>{13e-6, -7e-6, 5e-6, 11e-6, -3e-6};
  const SimplifiedInversion invert(NominalLayout(), MovingBody::kHead);
  for (const double d : {0.0, 60e-3}) {
    const HeadErrors<> e = invert({a, b, c, s, t}, d);
    const double eax = (c - b) / (2 * l);
    constexpr double kRounding = 1e-17;
    EXPECT_NEAR(e.eax, eax, kRounding);
    EXPECT_NEAR(e.ebx, (a - (b + c) / 2) / l, kRounding);
    EXPECT_NEAR(e.ecx, (s - t) / l, kRounding);
    EXPECT_NEAR(e.ezx, -(b + c) / 2, kRounding);
    EXPECT_NEAR(e.eyx, -s + h * eax, kRounding);
  }
}

// 100 urad of pitch and 60 mm: taking a moving head for a moving target is wrong by d EBX = 6 um.
TEST(SimplifiedInversion, MistakesTheLeverWhereTheOtherBodyMoves) {
  const HeadLayout<> layout = NominalLayout();
  const PerProbe<> delta =
      SmallAngleReadings(layout, MovingBody::kHead, HeadErrors<>{.ebx = 100e-6}, 60e-3);
  const HeadErrors<> wrong = SimplifiedInversion(layout, MovingBody::kTarget)(delta, 60e-3);
  EXPECT_NEAR(wrong.ezx, 6e-6, 1e-12);
}

// What the published inversion neglects, by expansion of both models to second order
// (docs/theory-head.md): it does not depend on the travel.
TEST(SimplifiedInversion, IsOffByTheProductsOfSecondOrder) {
  constexpr double h = 20e-3;
  const HeadLayout<> layout = NominalLayout();
  const HeadErrors<> e{0.9e-3, -0.7e-3, 0.8e-3, 41e-6, -37e-6, 0};
  const double bc = e.ebx * e.ecx, ac = e.eax * e.ecx, ab = e.eax * e.ebx;
  struct Expected {
    MovingBody moving;
    bool rigid;
    HeadErrors<> off;
  };
  const double a_y = e.eax * e.eyx, a_z = e.eax * e.ezx;
  const Expected table[] = {
      {MovingBody::kTarget, false, {-bc, ac, -ab, a_z - 2 * h * bc, -a_y}},
      {MovingBody::kTarget, true, {-bc / 2, ac / 2, -ab / 2, a_z - h * bc, -a_y}},
      {MovingBody::kHead, false, {}},
      {MovingBody::kHead, true, {bc / 2, -ac / 2, ab / 2, h * bc, 0}},
  };
  for (const Expected& row : table) {
    for (const double d : {0.0, 60e-3}) {
      const PerProbe<> delta = row.rigid ? RigidReadings(LinesOf(layout), row.moving, e, d)
                                         : SmallAngleReadings(layout, row.moving, e, d);
      const HeadErrors<> found = SimplifiedInversion(layout, row.moving)(delta, d);
      constexpr double kThirdOrder = 4e-9;  // rad: a few products of three angles of 1 mrad
      EXPECT_NEAR(found.eax - e.eax, row.off.eax, kThirdOrder);
      EXPECT_NEAR(found.ebx - e.ebx, row.off.ebx, kThirdOrder);
      EXPECT_NEAR(found.ecx - e.ecx, row.off.ecx, kThirdOrder);
      EXPECT_NEAR(found.eyx - e.eyx, row.off.eyx, kThirdOrder * (d + h));
      EXPECT_NEAR(found.ezx - e.ezx, row.off.ezx, kThirdOrder * (d + h));
    }
  }
}

TEST(HeadInversion, CorrectsAnInstalledHeadThatIsKnown) {
  const HeadLayout<> drawn = NominalLayout();
  const Installation<> askew{2e-3, 2e-3, 2e-3, 50e-6, 50e-6, 50e-6};
  const MeasuringLines<> lines = InstalledLines(drawn, askew);
  const HeadErrors<> e{0.7e-3, -0.4e-3, 0.5e-3, 31e-6, -17e-6, 0};
  const PerProbe<> delta = RigidReadings(lines, MovingBody::kTarget, e, 10e-3);
  const HeadErrors<> calibrated = RigidInversion(lines, MovingBody::kTarget)(delta, 10e-3);
  const HeadErrors<> tolerated = RigidInversion(LinesOf(drawn), MovingBody::kTarget)(delta, 10e-3);
  constexpr double kRounding = 1e-15;  // rad: a few roundings of normals of length 1
  EXPECT_NEAR(calibrated.ebx, e.ebx, kRounding);
  EXPECT_NEAR(calibrated.eyx, e.eyx, kRounding);
  // Untouched by calibration an installation of 2 mrad turns 2e-3 of a 0.5 mrad angle into another.
  EXPECT_GT(std::abs(tolerated.ebx - e.ebx), 0.1e-6);
  EXPECT_LT(std::abs(tolerated.ebx - e.ebx), 15e-6);
}

TEST(HeadInversion, RefusesTopProbesOnALine) {
  HeadLayout<> layout = NominalLayout();
  layout.top[0] = {0, 3e-3};
  for (const MovingBody moving : {MovingBody::kTarget, MovingBody::kHead}) {
    EXPECT_THROW(SimplifiedInversion(layout, moving), InputError);
    EXPECT_THROW(SmallAngleInversion(layout, moving), InputError);
    EXPECT_THROW(RigidInversion(LinesOf(layout), moving), InputError);
  }
}

TEST(HeadInversion, RefusesSideProbesAtOnePlaceAlongTheSweep) {
  HeadLayout<> layout = NominalLayout();
  layout.side[1] = {0, 30e-3};
  for (const MovingBody moving : {MovingBody::kTarget, MovingBody::kHead}) {
    EXPECT_THROW(SimplifiedInversion(layout, moving), InputError);
    EXPECT_THROW(SmallAngleInversion(layout, moving), InputError);
    EXPECT_THROW(RigidInversion(LinesOf(layout), moving), InputError);
  }
  layout.side[1] = layout.side[0];
  EXPECT_THROW(SimplifiedInversion(layout, MovingBody::kTarget), InputError);
}

TEST(HeadInversion, RefusesReadingsThatNoSmallMotionGives) {
  const HeadLayout<> layout = NominalLayout();
  for (const MovingBody moving : {MovingBody::kTarget, MovingBody::kHead}) {
    const SmallAngleInversion small_angle(layout, moving);
    const RigidInversion rigid(LinesOf(layout), moving);
    for (std::size_t k = 0; k < kProbes; ++k) {
      for (const double value : {kNan, kInf, -kInf, 1.0}) {  // 1 m over an arm of 10 mm
        PerProbe<> delta{};
        delta[k] = value;
        EXPECT_THROW(small_angle(delta, 0.01), NumericalError) << k << ' ' << value;
        EXPECT_THROW(rigid(delta, 0.01), NumericalError) << k << ' ' << value;
      }
    }
    EXPECT_THROW(small_angle({}, kNan), NumericalError);
  }
}

}  // namespace head_inversion_test
}  // namespace abbe::probes
