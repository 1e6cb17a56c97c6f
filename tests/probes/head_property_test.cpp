#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>

#include "probes/electrode.h"
#include "probes/head_inversion.h"
#include "probes/installation.h"

namespace abbe::probes {
namespace head_property_test {

constexpr double kEps = std::numeric_limits<double>::epsilon();
// The rounding of an angle: of slopes, that is differences of readings over an arm of some 5 mm,
// where the rigid model also rounds the components of normals, of order 1.
constexpr double kAngleRounding = 32 * kEps;
constexpr double kReach = 0.1;  // m: longest lever

double In(double low, double high) {
  return low + (high - low) * *rc::gen::inRange(0, 1'000'001) / 1e6;
}

HeadErrors<> AnyErrors(double angle, double length) {
  const auto a = [&] { return In(-angle, angle); };
  const auto s = [&] { return In(-length, length); };
  return {a(), a(), a(), s(), s(), s()};
}

// The nominal places, each off by up to 3 mm either way: never degenerate.
HeadLayout<> AnyLayout() {
  HeadLayout<> layout = NominalLayout();
  for (auto& [u, s] : layout.top) u += In(-3e-3, 3e-3), s += In(-3e-3, 3e-3);
  for (auto& [u, n] : layout.side) u += In(-3e-3, 3e-3), n += In(-3e-3, 3e-3);
  return layout;
}

MovingBody AnyBody() { return *rc::gen::element(MovingBody::kTarget, MovingBody::kHead); }

void AssertNear(const HeadErrors<>& found, const HeadErrors<>& e, double angle, double length) {
  RC_ASSERT(std::abs(found.eax - e.eax) < angle);
  RC_ASSERT(std::abs(found.ebx - e.ebx) < angle);
  RC_ASSERT(std::abs(found.ecx - e.ecx) < angle);
  RC_ASSERT(std::abs(found.eyx - e.eyx) < length);
  RC_ASSERT(std::abs(found.ezx - e.ezx) < length);
  RC_ASSERT(found.exx == e.exx);
}

RC_GTEST_PROP(HeadProperty, TheSmallAngleInversionLeavesOnlyRounding, ()) {
  const HeadLayout<> layout = AnyLayout();
  const MovingBody moving = AnyBody();
  const HeadErrors<> e = AnyErrors(20e-3, 1e-3);
  const double d = In(-0.06, 0.06);
  const PerProbe<> delta = SmallAngleReadings(layout, moving, e, d);
  // A head that moves does not see exx.
  AssertNear(SmallAngleInversion(layout, moving)(delta, d, e.exx), e, kAngleRounding,
             kAngleRounding * kReach);
}

RC_GTEST_PROP(HeadProperty, TheRigidInversionLeavesOnlyRounding, ()) {
  const Installation<> askew{In(-0.02, 0.02), In(-0.02, 0.02), In(-0.02, 0.02),
                             In(-1e-3, 1e-3), In(-1e-3, 1e-3), In(-1e-3, 1e-3)};
  const MeasuringLines<> lines = InstalledLines(AnyLayout(), askew);
  const MovingBody moving = AnyBody();
  const HeadErrors<> e = AnyErrors(20e-3, 1e-3);
  const double d = In(-0.06, 0.06);
  const PerProbe<> delta = RigidReadings(lines, moving, e, d);
  AssertNear(RigidInversion(lines, moving)(delta, d, e.exx), e, kAngleRounding,
             kAngleRounding * kReach);
}

RC_GTEST_PROP(HeadProperty, AHeadWithoutErrorMotionReadsZeroHoweverInstalled, ()) {
  const Installation<> askew{In(-0.1, 0.1),   In(-0.1, 0.1),   In(-0.1, 0.1),
                             In(-1e-3, 1e-3), In(-1e-3, 1e-3), In(-1e-3, 1e-3)};
  const MeasuringLines<> lines = InstalledLines(AnyLayout(), askew);
  const double d = In(-0.06, 0.06);
  for (const double delta : RigidReadings(lines, AnyBody(), HeadErrors<>{}, d)) {
    RC_ASSERT(std::abs(delta) < 4 * kEps * kReach);
  }
}

RC_GTEST_PROP(HeadProperty, TheElectrodeIsUndone, ()) {
  const Electrode electrode{In(0, 5e-3), In(0, 2e3)};
  const double gap = In(20e-6, 200e-6);
  const double tilt = In(-0.99, 0.99) * gap / 5e-3;
  const double reading = ElectrodeReading(electrode, gap, tilt);
  RC_ASSERT(reading <= gap);
  RC_ASSERT(std::abs(ElectrodeGap(electrode, reading, tilt) - gap) < 16 * kEps * gap);
}

}  // namespace head_property_test
}  // namespace abbe::probes
