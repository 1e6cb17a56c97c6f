// The sines, cosines and arc tangents of each width against those of the C library in 64 bits of
// mantissa.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "random/counter_random.h"
#include "tests/each_width.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/relm/vector_trigonometry_test.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "relm/vector_trigonometry.h"

HWY_BEFORE_NAMESPACE();
namespace abbe::relm::HWY_NAMESPACE {

// The number of values is a multiple of every width.
void SinesAndCosines(const double* angles, std::size_t count, double* sines, double* cosines) {
  const hn::ScalableTag<double> d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto [sine, cosine] = SineAndCosineOf(hn::LoadU(d, angles + i));
    hn::StoreU(sine, d, sines + i);
    hn::StoreU(cosine, d, cosines + i);
  }
}

void ArcTangents(const double* y, const double* x, std::size_t count, double* angles) {
  const hn::ScalableTag<double> d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    hn::StoreU(ArcTangentOf(hn::LoadU(d, y + i), hn::LoadU(d, x + i)), d, angles + i);
  }
}

}  // namespace abbe::relm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace abbe::relm {

HWY_EXPORT(SinesAndCosines);
HWY_EXPORT(ArcTangents);

namespace vector_trigonometry_test {

constexpr std::size_t kCount = 1 << 16;
constexpr double kMostUnits = 2.5;

double Units(double value, long double truth) {
  const double size = std::abs(static_cast<double>(truth));
  const double unit = std::nextafter(size, std::numeric_limits<double>::infinity()) - size;
  return static_cast<double>(std::abs(value - truth)) / unit;
}

void ExpectSinesAndCosines(const std::vector<double>& angles) {
  test::OnEachWidth([&] {
    std::vector<double> sines(angles.size()), cosines(angles.size());
    HWY_DYNAMIC_DISPATCH(SinesAndCosines)
    (angles.data(), angles.size(), sines.data(), cosines.data());
    double worst = 0;
    for (std::size_t i = 0; i < angles.size(); ++i) {
      worst = std::max({worst, Units(sines[i], std::sin(static_cast<long double>(angles[i]))),
                        Units(cosines[i], std::cos(static_cast<long double>(angles[i])))});
    }
    EXPECT_LT(worst, kMostUnits);
  });
}

std::vector<double> AnglesUpTo(double size) {
  std::vector<double> angles(kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    angles[i] = random::CounterRandom(1, 1).Uniform(i, -size, size);
  }
  return angles;
}

TEST(VectorTrigonometry, HasTheSinesAndCosinesOfATurn) { ExpectSinesAndCosines(AnglesUpTo(3.2)); }

TEST(VectorTrigonometry, HasTheSinesAndCosinesOfSmallAngles) {
  ExpectSinesAndCosines(AnglesUpTo(1e-3));
  ExpectSinesAndCosines(std::vector<double>(64, 0.0));
  ExpectSinesAndCosines(std::vector<double>(64, 1e-300));
}

TEST(VectorTrigonometry, HasTheSinesAndCosinesOfTheLargestAngles) {
  ExpectSinesAndCosines(AnglesUpTo(1.6e6));
}

// At multiples of pi / 4 the octant changes, and at those of pi / 2 a result is as small as the
// rounding of the angle.
TEST(VectorTrigonometry, HasTheSinesAndCosinesAroundTheQuarters) {
  std::vector<double> angles(kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    const double eighth = (static_cast<double>(i / 4) - 8192) * (i % 8 < 4 ? 1 : 243);
    angles[i] = eighth * (std::acos(-1.0) / 4) * (1 + (static_cast<int>(i % 4) - 2) * 0x1p-52);
  }
  ExpectSinesAndCosines(angles);
}

void ExpectArcTangents(const std::vector<double>& y, const std::vector<double>& x) {
  test::OnEachWidth([&] {
    std::vector<double> angles(y.size());
    HWY_DYNAMIC_DISPATCH(ArcTangents)(y.data(), x.data(), y.size(), angles.data());
    double worst = 0;
    for (std::size_t i = 0; i < y.size(); ++i) {
      const auto truth = std::atan2(static_cast<long double>(y[i]), static_cast<long double>(x[i]));
      worst = std::max(worst, Units(angles[i], truth));
      EXPECT_EQ(std::signbit(angles[i]), std::signbit(y[i]));
    }
    EXPECT_LT(worst, kMostUnits);
  });
}

TEST(VectorTrigonometry, HasTheArcTangentsOfAllDirections) {
  for (const double flat : {1.0, 1e-3, 1e3, 1e-200, 1e200}) {
    std::vector<double> y(kCount), x(kCount);
    for (std::size_t i = 0; i < kCount; ++i) {
      y[i] = random::CounterRandom(1, 1).Uniform(i, -1, 1);
      x[i] = flat * random::CounterRandom(1, 2).Uniform(i, -1, 1);
    }
    ExpectArcTangents(y, x);
  }
}

TEST(VectorTrigonometry, HasTheArcTangentsOfTheAxesAndDiagonals) {
  const double none = 0, tangent = std::sqrt(2.0) - 1;
  std::vector<double> y, x;
  for (const double b : {none, -none, 1.0, -1.0, tangent, -tangent, std::nextafter(tangent, 0.0)}) {
    for (const double a :
         {none, -none, 1.0, -1.0, tangent, -tangent, std::nextafter(tangent, 1.)}) {
      if (a == 0 && b == 0) continue;
      y.push_back(b);
      x.push_back(a);
    }
  }
  y.resize(64, 1.0);
  x.resize(64, 1.0);
  ExpectArcTangents(y, x);
}

}  // namespace vector_trigonometry_test
}  // namespace abbe::relm
#endif  // HWY_ONCE
