#include "probes/installation.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "probes/head_model.h"
#include "random/counter_random.h"

namespace abbe::probes {
namespace installation_test {

using std::cos, std::sin;
constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kArm = 10e-3, kSideHeight = 20e-3, kRadius = 10e-6;

TEST(Installation, IsThePrintedTransform) {
  const double r = 0.02, p = -0.03, y = 0.05;
  const double Sr = sin(r), Cr = cos(r), Sp = sin(p), Cp = cos(p), Sy = sin(y), Cy = cos(y);
  Eigen::Matrix3d printed;
  printed << Cp * Cy, -Cp * Sy, Sp,                              //
      Sr * Sp * Cy + Cr * Sy, Cr * Cy - Sr * Sp * Sy, -Sp * Sr,  // the last entry is a misprint
      -Cr * Sp * Cy + Sr * Sy, Sr * Cy + Cr * Sp * Sy, Cr * Cp;
  const Eigen::Matrix3d R = InstallationRotation(Installation<>{.roll = r, .pitch = p, .yaw = y});
  EXPECT_GT((printed * printed.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-3);
  printed(1, 2) = -Cp * Sr;
  EXPECT_LT((R - printed).norm(), 4 * kEps);
}

struct Case {
  HeadErrors<> e;
  Installation<> i;
  PerProbe<> alpha;  // rad: where on its circle of radius r each probe stands
  double d;
};

Case RandomCase(std::uint64_t k) {
  const random::CounterRandom random(5, 0);
  const auto in = [&](std::uint64_t n, double size) {
    return random.Uniform(32 * k + n, -size, size);
  };
  Case c;
  c.e = {in(0, 1e-3), in(1, 1e-3), in(2, 1e-3), in(3, 50e-6), in(4, 50e-6), in(5, 50e-6)};
  c.i = {0, in(6, 2e-3), in(7, 2e-3), in(8, 50e-6), in(9, 50e-6), in(10, 50e-6)};
  for (std::size_t n = 0; n < kProbes; ++n) c.alpha[n] = in(11 + n, 3.14);
  c.d = random.Uniform(32 * k + 16, 0, 60e-3);
  return c;
}

HeadLayout<> Manufactured(const PerProbe<>& alpha) {  // equations 13 to 15, and the side probes
  HeadLayout<> layout = NominalLayout(kArm, kSideHeight);
  for (std::size_t n = 0; n < kTopProbes; ++n) {
    layout.top[n].u += kRadius * cos(alpha[n]);
    layout.top[n].s += kRadius * sin(alpha[n]);
  }
  for (std::size_t n = 0; n < kSideProbes; ++n) {
    layout.side[n].u += kRadius * cos(alpha[kTopProbes + n]);
    layout.side[n].n += kRadius * sin(alpha[kTopProbes + n]);
  }
  return layout;
}

// Equations 16 to 20, term by term as printed save for what is named. Derived by putting the
// source's installed coordinates x' = x - y theta_y + sigma_x, y' = y + x theta_y + sigma_y (top)
// and x' = x + z theta_p + sigma_x, z' = z - x theta_p + sigma_z (side) into its equations 2 and 6.

// Printed wrong in 16: a factor theta_y after (l + r cos) in the lever of EAX; ECX missing there
// (it reads EAX); y_p1 left in the last bracket for r sin.
double Equation16(const Case& c, double r, double l) {
  const auto& [a, b, z, dy, dz, dx] = c.e;
  const double al = c.alpha[0], ty = c.i.yaw, sx = c.i.du, sy = c.i.ds, d = c.d + dx;
  return (a * (r * sin(al) - dy + (l + r * cos(al)) * ty +
               (d - (l + r * cos(al)) + r * sin(al) * ty - sx) * z + sy) +
          b * (d - (l + r * cos(al)) + r * sin(al) * ty - sx +
               z * (-r * sin(al) + dy - (l + r * cos(al)) * ty - sy)) +
          dz * (1 + z * z)) /
         (1 + z * z);
}

// Printed wrong in 17: (r sin) theta_y for (r cos) theta_y in the first bracket; a factor theta_y
// after r cos in the lever of EAX.
double Equation17(const Case& c, double r, double l) {
  const auto& [a, b, z, dy, dz, dx] = c.e;
  const double al = c.alpha[1], ty = c.i.yaw, sx = c.i.du, sy = c.i.ds, d = c.d + dx;
  return (a * ((l + r * sin(al)) - dy + r * cos(al) * ty +
               (d - r * cos(al) + (l + r * sin(al)) * ty - sx) * z + sy) +
          b * (d - r * cos(al) + (l + r * sin(al)) * ty - sx +
               z * (-l - r * sin(al) + dy - r * cos(al) * ty - sy)) +
          dz * (1 + z * z)) /
         (1 + z * z);
}

// Printed wrong in 18: (r sin) theta_y for (r cos) theta_y; (l - r cos) theta for d - r cos in the
// lever of EAX; alpha_B for alpha_C in the last bracket.
double Equation18(const Case& c, double r, double l) {
  const auto& [a, b, z, dy, dz, dx] = c.e;
  const double al = c.alpha[2], ty = c.i.yaw, sx = c.i.du, sy = c.i.ds, d = c.d + dx;
  return (a * ((-l + r * sin(al)) - dy + r * cos(al) * ty +
               (d - r * cos(al) + (-l + r * sin(al)) * ty - sx) * z + sy) +
          b * (d - r * cos(al) + (-l + r * sin(al)) * ty - sx +
               z * (l - r * sin(al) + dy - r * cos(al) * ty - sy)) +
          dz * (1 + z * z)) /
         (1 + z * z);
}

// Printed wrong in 19: sigma_x for sigma_z in the first and the last bracket, delta_xx for
// delta_zx, 1 + EAX^2 for 1 + EBX^2 beside delta_yx. In 20 the same, and the l of probe E is
// missing: r cos must be l + r cos throughout. `x` is 0 for D and l for E.
double Equations19And20(const Case& c, double r, double l2, double x, double al) {
  const auto& [a, b, z, dy, dz, dx] = c.e;
  const double tp = c.i.pitch, sx = c.i.du, sz = c.i.dn, d = c.d + dx;
  const double xc = x + r * cos(al), zs = l2 + r * sin(al);
  return (a * (-zs + dz + xc * tp + (d - xc - zs * tp - sx) * b - sz) + dy * (1 + b * b) -
          (d - xc - zs * tp - sx + (zs - dz - xc * tp + sz) * b) * z) /
         (1 + b * b);
}

TEST(Installation, AgreesWithEquations16To20) {
  for (std::uint64_t k = 0; k < 300; ++k) {
    const Case c = RandomCase(k);
    const auto layout = InstalledLayout(Manufactured(c.alpha), c.i);
    const PerProbe<> delta = SmallAngleReadings(layout, MovingBody::kTarget, c.e, c.d);
    const double rounding = 16 * kEps * 1e-3 * 60e-3;
    EXPECT_NEAR(delta[0], Equation16(c, kRadius, kArm), rounding);
    EXPECT_NEAR(delta[1], Equation17(c, kRadius, kArm), rounding);
    EXPECT_NEAR(delta[2], Equation18(c, kRadius, kArm), rounding);
    EXPECT_NEAR(delta[3], Equations19And20(c, kRadius, kSideHeight, 0, c.alpha[3]), rounding);
    EXPECT_NEAR(delta[4], Equations19And20(c, kRadius, kSideHeight, kArm, c.alpha[4]), rounding);
  }
}

// The source's own way there: T^-1 times the installation matrix reduced to yaw, sigma_x and
// sigma_y, solved for the height at which the top surface is met.
TEST(Installation, AgreesWithTheSourcesMatrices) {
  for (std::uint64_t k = 0; k < 100; ++k) {
    const Case c = RandomCase(k);
    Eigen::Matrix4d T, I;
    T << 1, -c.e.ecx, c.e.ebx, c.d + c.e.exx, c.e.ecx, 1, -c.e.eax, c.e.eyx, -c.e.ebx, c.e.eax, 1,
        c.e.ezx, 0, 0, 0, 1;
    I << 1, -c.i.yaw, 0, c.i.du, c.i.yaw, 1, 0, c.i.ds, 0, 0, 1, 0, 0, 0, 0, 1;
    const Eigen::RowVector4d row = (T.inverse() * I).row(2);
    const HeadLayout<> made = Manufactured(c.alpha);
    const PerProbe<> delta =
        SmallAngleReadings(InstalledLayout(made, c.i), MovingBody::kTarget, c.e, c.d);
    for (std::size_t n = 0; n < kTopProbes; ++n) {
      const double height = -(row[0] * made.top[n].u + row[1] * made.top[n].s + row[3]) / row[2];
      EXPECT_NEAR(delta[n], height, 32 * kEps * 60e-3);
    }
  }
}

// The exact lines meet the surfaces where the first-order layout says, up to the square of the
// angles times the position, plus the angle times the offset along the line.
TEST(Installation, LinesAndLayoutAgreeToFirstOrder) {
  const HeadLayout<> drawn = NominalLayout();
  for (const double scale : {1.0, 0.1}) {
    const Installation<> i{2e-3 * scale, -2e-3 * scale, 1.5e-3 * scale,
                           5e-5 * scale, -5e-5 * scale, 4e-5 * scale};
    const MeasuringLines<> lines = InstalledLines(drawn, i);
    const HeadLayout<> layout = InstalledLayout(drawn, i);
    const double second_order = scale * scale * (4 * 4e-6 * 20e-3 + 2 * 2e-3 * 5e-5);
    for (std::size_t n = 0; n < kTopProbes; ++n) {
      EXPECT_NEAR(lines[n].point.x(), layout.top[n].u, second_order);
      EXPECT_NEAR(lines[n].point.y(), layout.top[n].s, second_order);
      EXPECT_NEAR(lines[n].point.z(), 0, kEps * 20e-3);
    }
    for (std::size_t n = 0; n < kSideProbes; ++n) {
      EXPECT_NEAR(lines[kTopProbes + n].point.x(), layout.side[n].u, second_order);
      EXPECT_NEAR(lines[kTopProbes + n].point.z(), layout.side[n].n, second_order);
      EXPECT_NEAR(lines[kTopProbes + n].point.y(), 0, kEps * 20e-3);
    }
  }
}

}  // namespace installation_test
}  // namespace abbe::probes
