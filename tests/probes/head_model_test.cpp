#include "probes/head_model.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "probes/installation.h"
#include "random/counter_random.h"

namespace abbe::probes {
namespace head_model_test {

using Eigen::Vector3d;
constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kTravel = 60e-3;  // m

// Errors as in the source's simulations, scaled.
HeadErrors<> RandomErrors(std::uint64_t i, double scale = 1) {
  const random::CounterRandom random(11, 0);
  const auto in = [&](std::uint64_t k, double size) {
    return scale * random.Uniform(6 * i + k, -size, size);
  };
  return {in(0, 1e-3), in(1, 1e-3), in(2, 1e-3), in(3, 50e-6), in(4, 50e-6), in(5, 50e-6)};
}

// The source's T, with the sign of its -EBX entry.
Eigen::Matrix4<long double> SmallAngleT(const HeadErrors<>& e, double d) {
  Eigen::Matrix4<long double> T;
  T << 1, -e.ecx, e.ebx, static_cast<long double>(d) + e.exx,  //
      e.ecx, 1, -e.eax, e.eyx,                                 //
      -e.ebx, e.eax, 1, e.ezx,                                 //
      0, 0, 0, 1;
  return T;
}

// The surface has coordinate zero in the target's frame: row . (point, 1) = 0 solved for the
// unknown coordinate of the point.
double OnSurface(const Eigen::Matrix4<long double>& T, int normal, double x, double other) {
  const Eigen::Matrix<long double, 1, 4> row = T.inverse().row(normal);
  const int known = 3 - normal;
  return static_cast<double>(-(row[0] * x + row[known] * other + row[3]) / row[normal]);
}

TEST(SmallAngleModel, IsTheSurfaceOfTheTransformedTarget) {
  const HeadLayout<> layout = NominalLayout();
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const HeadErrors<> e = RandomErrors(i);
    const double d = kTravel * static_cast<double>(i) / 1000;
    const auto T = SmallAngleT(e, d);
    const PerProbe<> delta = SmallAngleReadings(layout, MovingBody::kTarget, e, d);
    // A reading is a sum of some ten terms, the largest about angle * d.
    const double rounding = 16 * kEps * 1e-3 * kTravel;
    for (std::size_t k = 0; k < kTopProbes; ++k) {
      EXPECT_NEAR(delta[k], OnSurface(T, 2, layout.top[k].u, layout.top[k].s), rounding);
    }
    for (std::size_t k = 0; k < kSideProbes; ++k) {
      EXPECT_NEAR(delta[3 + k], OnSurface(T, 1, layout.side[k].u, layout.side[k].n), rounding);
    }
  }
}

// Where the moved head's probe, carried by T, meets the surface of the standing target.
TEST(SmallAngleModel, OfAMovingHeadIsTheHeightOfTheTransformedProbes) {
  const HeadLayout<> layout = NominalLayout();
  for (std::uint64_t i = 0; i < 200; ++i) {
    const HeadErrors<> e = RandomErrors(i);
    const auto T = SmallAngleT(e, 0.03);
    const PerProbe<> delta = SmallAngleReadings(layout, MovingBody::kHead, e, 0.03);
    const double rounding = 16 * kEps * 100e-6;
    const auto [u, s] = layout.top[1];
    EXPECT_NEAR(delta[1], static_cast<double>(-(T * Eigen::Vector4<long double>(u, s, 0, 1))[2]),
                rounding);
    const auto [ue, n] = layout.side[1];
    EXPECT_NEAR(delta[4], static_cast<double>(-(T * Eigen::Vector4<long double>(ue, 0, n, 1))[1]),
                rounding);
  }
}

Eigen::Isometry3d RigidPose(const HeadErrors<>& e, double d) {
  const Vector3d angles(e.eax, e.ebx, e.ecx);
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  if (angles.norm() > 0)
    X.linear() = Eigen::AngleAxisd(angles.norm(), angles.normalized()).matrix();
  X.translation() = Vector3d(d + e.exx, e.eyx, e.ezx);
  return X;
}

// The reading leads from the probe's point along its line to a point that lies in the surface.
TEST(RigidModel, ReachesTheSurfaceAlongTheMeasuringLine) {
  const MeasuringLines<> lines =
      InstalledLines(NominalLayout(), Installation<>{2e-3, -1e-3, 3e-3, 1e-4, -2e-4, 3e-4});
  for (std::uint64_t i = 0; i < 500; ++i) {
    const HeadErrors<> e = RandomErrors(i, 10);
    const Eigen::Isometry3d X = RigidPose(e, kTravel);
    const PerProbe<> target = RigidReadings(lines, MovingBody::kTarget, e, kTravel);
    const PerProbe<> head = RigidReadings(lines, MovingBody::kHead, e, kTravel);
    for (std::size_t k = 0; k < kProbes; ++k) {
      const int normal = k < kTopProbes ? 2 : 1;
      const double rounding = 16 * kEps * kTravel;
      EXPECT_NEAR((X.inverse() * (lines[k].point + target[k] * lines[k].direction))[normal], 0,
                  rounding);
      EXPECT_NEAR((X * (lines[k].point + head[k] * lines[k].direction))[normal], 0, rounding);
    }
  }
}

struct Sign {
  const char* name;
  HeadErrors<> errors;
  PerProbe<> target, head;  // readings per unit error at d, to first order
};

// In words: a pitch up of the table by the right-hand rule about s lowers its far end, so at d > 0
// the part under the head, which lies behind the axis reference, comes up; and so on.
TEST(HeadModel, HasTheSignsOfTheFirstOrderTable) {
  constexpr double d = 50e-3, l = 10e-3, h = 20e-3;
  const Sign signs[] = {
      {"roll", {.eax = 1}, {0, l, -l, -h, -h}, {0, -l, l, h, h}},
      {"pitch", {.ebx = 1}, {d - l, d, d, 0, 0}, {l, 0, 0, 0, 0}},
      {"yaw", {.ecx = 1}, {0, 0, 0, -d, l - d}, {0, 0, 0, 0, -l}},
      {"side", {.eyx = 1}, {0, 0, 0, 1, 1}, {0, 0, 0, -1, -1}},
      {"top", {.ezx = 1}, {1, 1, 1, 0, 0}, {-1, -1, -1, 0, 0}},
      {"positioning", {.exx = 1}, {0, 0, 0, 0, 0}, {0, 0, 0, 0, 0}},
  };
  const HeadLayout<> layout = NominalLayout();
  constexpr double kStep = 1e-6;  // second order is then at most 1e-6 of the first
  for (const Sign& sign : signs) {
    const auto& f = sign.errors;
    const HeadErrors<> e{kStep * f.eax, kStep * f.ebx, kStep * f.ecx,
                         kStep * f.eyx, kStep * f.ezx, kStep * f.exx};
    for (const MovingBody moving : {MovingBody::kTarget, MovingBody::kHead}) {
      const PerProbe<> small_angle = SmallAngleReadings(layout, moving, e, d);
      const PerProbe<> rigid = RigidReadings(LinesOf(layout), moving, e, d);
      const PerProbe<>& expected = moving == MovingBody::kTarget ? sign.target : sign.head;
      for (std::size_t k = 0; k < kProbes; ++k) {
        EXPECT_NEAR(small_angle[k] / kStep, expected[k], 1e-6) << sign.name << " probe " << k;
        EXPECT_NEAR(rigid[k] / kStep, expected[k], 1e-6) << sign.name << " probe " << k;
      }
    }
  }
}

double LargestDifference(double scale, MovingBody moving) {
  const HeadLayout<> layout = NominalLayout();
  double largest = 0;
  for (std::uint64_t i = 0; i < 500; ++i) {
    const HeadErrors<> e = RandomErrors(i, scale);
    const PerProbe<> small_angle = SmallAngleReadings(layout, moving, e, kTravel);
    const PerProbe<> rigid = RigidReadings(LinesOf(layout), moving, e, kTravel);
    for (std::size_t k = 0; k < kProbes; ++k) {
      largest = std::max(largest, std::abs(small_angle[k] - rigid[k]));
    }
  }
  return largest;
}

TEST(HeadModel, TheTwoModelsDifferBySecondOrder) {
  for (const MovingBody moving : {MovingBody::kTarget, MovingBody::kHead}) {
    const double full = LargestDifference(1, moving), tenth = LargestDifference(0.1, moving);
    // Half a product of two angles (1 mrad)^2 times the lever: d + l, or 2 l for a moving head.
    const double lever = moving == MovingBody::kTarget ? kTravel + 30e-3 : 30e-3;
    EXPECT_LT(full, 0.5e-6 * lever);
    EXPECT_GT(full, 0.25e-6 * lever);
    EXPECT_NEAR(full / tenth, 100, 2);  // third order changes the ratio by a few parts in 1000
  }
}

// ceres::Jet: the derivatives at zero error are the first-order coefficients.
TEST(HeadModel, CarriesDerivatives) {
  using Jet = ceres::Jet<double, 5>;
  const HeadErrors<Jet> e{Jet(0, 0), Jet(0, 1), Jet(0, 2), Jet(0, 3), Jet(0, 4), Jet(0)};
  MeasuringLines<Jet> lines;
  const MeasuringLines<> drawn = LinesOf(NominalLayout());
  for (std::size_t k = 0; k < kProbes; ++k) {
    lines[k] = {drawn[k].point.cast<Jet>(), drawn[k].direction.cast<Jet>()};
  }
  const PerProbe<Jet> delta = RigidReadings(lines, MovingBody::kTarget, e, Jet(50e-3));
  Eigen::Matrix<double, 5, 5> expected;  // output probe, input error
  expected << 0, 40e-3, 0, 0, 1,         //
      10e-3, 50e-3, 0, 0, 1,             //
      -10e-3, 50e-3, 0, 0, 1,            //
      -20e-3, 0, -50e-3, 1, 0,           //
      -20e-3, 0, -40e-3, 1, 0;
  for (std::size_t k = 0; k < kProbes; ++k) {
    EXPECT_LT((delta[k].v.transpose() - expected.row(static_cast<int>(k))).norm(), 4 * kEps);
  }
}

}  // namespace head_model_test
}  // namespace abbe::probes
