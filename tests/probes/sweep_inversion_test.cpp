#include "probes/sweep_inversion.h"

#include <gtest/gtest.h>

#include "tests/probes/synthetic_sweep.h"

namespace abbe::probes {
namespace sweep_inversion_test {

constexpr HeadErrors<> kErrors{
    .eax = 11e-6, .ebx = -23e-6, .ecx = 37e-6, .eyx = 1.5e-6, .ezx = -2.5e-6};
// What is left is the rounding of gaps of 100 um (1e-20 m) over arms of 10 mm, times d.
constexpr double kAngle = 1e-15, kLength = 1e-16;

// One station without error and one after this motion, inverted again.
GroupErrors Recovered(const SweepSetup& setup, char axis, const HeadErrors<>& e, double d,
                      const Eigen::Vector3d& start) {
  const SweepInversion inversion(setup.machine, setup.head, axis, start);
  const auto lines = InstalledLines(setup.head.layout, setup.head.installation);
  const PerProbe<> delta = RigidReadings(lines, inversion.moving(), e, d);
  GroupReadings gaps(kProbes, 2);
  for (std::size_t p = 0; p < kProbes; ++p) {
    gaps.row(static_cast<Eigen::Index>(p)) << 100e-6, 100e-6 - delta[p];
  }
  const double at = start[axis - 'X'];
  return inversion.Errors(gaps, Eigen::Vector2d(at, at + d), 1);
}

TEST(SweepInversion, NamesTheErrorsByIso) {
  const SweepSetup setup = TestSetup();
  const auto names = [&](char axis) {
    const SweepInversion inversion(setup.machine, setup.head, axis, Eigen::Vector3d::Zero());
    std::string joined;
    for (const Component& component : inversion.components()) joined += component.name + " ";
    return joined;
  };
  EXPECT_EQ(names('X'), "EAX EBX ECX EYX EZX ");
  EXPECT_EQ(names('Y'), "EAY EBY ECY EXY EZY ");
  EXPECT_EQ(names('Z'), "EAZ EBZ ECZ EXZ EYZ ");
}

// The head frame (u, s, n) of X is (x, y, z).
TEST(SweepInversion, XAtTheTargetIsTheHeadFrame) {
  const GroupErrors errors = Recovered(TestSetup(), 'X', kErrors, 30e-3, Eigen::Vector3d::Zero());
  EXPECT_NEAR(errors(5, 1), kErrors.eax, kAngle);
  EXPECT_NEAR(errors(6, 1), kErrors.ebx, kAngle);
  EXPECT_NEAR(errors(7, 1), kErrors.ecx, kAngle);
  EXPECT_NEAR(errors(8, 1), kErrors.eyx, kLength);
  EXPECT_NEAR(errors(9, 1), kErrors.ezx, kLength);
}

// That of Y is (y, -x, z): roll = EBY, pitch = -EAY, yaw = ECY; s is -x.
TEST(SweepInversion, YTurnsRollIntoEBY) {
  const GroupErrors errors = Recovered(TestSetup(), 'Y', kErrors, 30e-3, Eigen::Vector3d::Zero());
  EXPECT_NEAR(errors(5, 1), -kErrors.ebx, kAngle);
  EXPECT_NEAR(errors(6, 1), kErrors.eax, kAngle);
  EXPECT_NEAR(errors(7, 1), kErrors.ecx, kAngle);
  EXPECT_NEAR(errors(8, 1), -kErrors.eyx, kLength);
  EXPECT_NEAR(errors(9, 1), kErrors.ezx, kLength);
}

// That of Z is (z, y, -x), and the head moves.
TEST(SweepInversion, ZMovesTheHeadAndLooksAlongMinusX) {
  const GroupErrors errors = Recovered(TestSetup(), 'Z', kErrors, 30e-3, Eigen::Vector3d::Zero());
  EXPECT_NEAR(errors(5, 1), -kErrors.ecx, kAngle);
  EXPECT_NEAR(errors(6, 1), kErrors.ebx, kAngle);
  EXPECT_NEAR(errors(7, 1), kErrors.eax, kAngle);
  EXPECT_NEAR(errors(8, 1), -kErrors.ezx, kLength);
  EXPECT_NEAR(errors(9, 1), kErrors.eyx, kLength);
}

// EYX_target = EYX + x0 ECX - z0 EAX, EZX_target = EZX - x0 EBX + y0 EAX, with
// (x0, y0, z0) = head - reference - the travels at the start of X and of Y, which carries X.
TEST(SweepInversion, TheReferenceIsReachedByTheAbbeArms) {
  const Eigen::Vector3d start(2e-3, 7e-3, 9e-3);
  const GroupErrors errors = Recovered(TestSetup(), 'X', kErrors, 30e-3, start);
  const double x0 = 20e-3 - 3e-3 - 2e-3, y0 = 15e-3 + 4e-3 - 7e-3, z0 = 40e-3 - 5e-3;
  EXPECT_NEAR(errors(8, 1), errors(3, 1) + x0 * kErrors.ecx - z0 * kErrors.eax, kLength);
  EXPECT_NEAR(errors(9, 1), errors(4, 1) - x0 * kErrors.ebx + y0 * kErrors.eax, kLength);
}

TEST(SweepInversion, InstallationGainAndElectrodeAreCorrected) {
  SweepSetup setup = TestSetup();
  setup.head.installation = {
      .roll = 1e-3, .pitch = -2e-3, .yaw = 1.5e-3, .du = 50e-6, .ds = -30e-6, .dn = 20e-6};
  setup.head.electrode = {.radius = 2e-3, .stray = 30.0};
  setup.head.probes[1].gain = 1.002;
  const double d = 30e-3;
  const SweepInversion inversion(setup.machine, setup.head, 'X', Eigen::Vector3d::Zero());
  const auto& fixed = setup.head.installation;
  const auto lines = InstalledLines(setup.head.layout, fixed);
  const PerProbe<> delta = RigidReadings(lines, MovingBody::kTarget, kErrors, d);
  GroupReadings readings(kProbes, 2);
  for (std::size_t p = 0; p < kProbes; ++p) {
    const bool top = p < kTopProbes;
    const double before = std::hypot(fixed.roll, top ? fixed.pitch : fixed.yaw);
    const double after = std::hypot(kErrors.eax - fixed.roll,
                                    top ? kErrors.ebx - fixed.pitch : kErrors.ecx - fixed.yaw);
    const double gap = 100e-6 - setup.head.probes[p].gain * delta[p];
    readings.row(static_cast<Eigen::Index>(p))
        << ElectrodeReading(setup.head.electrode, 100e-6, before),
        ElectrodeReading(setup.head.electrode, gap, after);
  }
  const GroupErrors errors = inversion.Errors(readings, Eigen::Vector2d(0.0, d), 1);
  // The tilt correction is (a phi)^2 / 4g = 40 nm and is made with an angle that is wrong by 1e-3.
  EXPECT_NEAR(errors(5, 1), kErrors.eax, 1e-9);
  EXPECT_NEAR(errors(6, 1), kErrors.ebx, 1e-9);
  EXPECT_NEAR(errors(7, 1), kErrors.ecx, 1e-9);
  EXPECT_NEAR(errors(8, 1), kErrors.eyx, 1e-11);
  EXPECT_NEAR(errors(9, 1), kErrors.ezx, 1e-11);
}

// The Jacobian of the first-order inversion (docs/theory-head.md).
TEST(SweepInversion, ItsJacobianIsThatOfTheFirstOrderModel) {
  const SweepSetup setup = TestSetup();
  const double d = 30e-3, arm = 10e-3, high = 20e-3;
  const SweepInversion inversion(setup.machine, setup.head, 'X', Eigen::Vector3d::Zero());
  const GroupReadings gaps = GroupReadings::Constant(kProbes, 2, 100e-6);
  const GroupJacobian J = inversion.Jacobians(gaps, Eigen::Vector2d(0.0, d), 1)[1];
  Eigen::Matrix<double, 5, 5> expected;
  expected << 0, 0.5 / arm, -0.5 / arm, 0, 0,                        //
      -1 / arm, 0.5 / arm, 0.5 / arm, 0, 0,                          //
      0, 0, 0, -1 / arm, 1 / arm,                                    //
      0, high * 0.5 / arm, -high * 0.5 / arm, 1 - d / arm, d / arm,  //
      d / arm, 0.5 - d * 0.5 / arm, 0.5 - d * 0.5 / arm, 0, 0;
  // Central differences of 0.1 um neglect (0.1 um / 10 mm)^2 = 1e-10 of the largest entry.
  EXPECT_LT((J.bottomRows<5>() - expected).cwiseAbs().maxCoeff(), 1e-7);
}

}  // namespace sweep_inversion_test
}  // namespace abbe::probes
