// Many stations at once, with each width of vectors, against the inversion of single stations and the
// errors that the readings were made of.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "failure/failure.h"
#include "probes/head_inversion.h"
#include "probes/inversion_of_rows.h"
#include "random/counter_random.h"
#include "tests/each_width.h"

namespace abbe::probes {
namespace head_inversion_batch_test {

using Eigen::Index;
using Readings = SmallAngleInversion::Readings;
using Errors = SmallAngleInversion::Errors;

constexpr double kEps = std::numeric_limits<double>::epsilon();
// Sizes of what goes into an error: a reading, of 60 um, and a difference of readings over the arm.
constexpr double kReading = 1e-3 * 60e-3 + 50e-6, kOverArm = kReading / 10e-3;

struct Stations {
  Readings readings;
  Eigen::VectorXd d, exx;
  Errors truth;
};

Stations Drawn(MovingBody moving, Index count) {
  Stations s{Readings(count, 5), Eigen::VectorXd(count), Eigen::VectorXd(count), Errors(count, 6)};
  const random::CounterRandom random(3, 1);
  for (Index i = 0; i < count; ++i) {
    const auto in = [&](Index k, double size) { return random.Uniform(8 * i + k, -size, size); };
    const HeadErrors<long double> e{in(0, 1e-3),  in(1, 1e-3),  in(2, 1e-3),
                                    in(3, 50e-6), in(4, 50e-6), in(5, 20e-6)};
    const long double d = random.Uniform(8 * i + 6, 0, 60e-3);
    HeadLayout<long double> layout;
    const HeadLayout<> nominal = NominalLayout();
    for (std::size_t k = 0; k < kTopProbes; ++k) {
      layout.top[k] = {nominal.top[k].u, nominal.top[k].s};
    }
    for (std::size_t k = 0; k < kSideProbes; ++k) {
      layout.side[k] = {nominal.side[k].u, nominal.side[k].n};
    }
    const auto readings = SmallAngleReadings<long double>(layout, moving, e, d);
    for (Index k = 0; k < 5; ++k) {
      s.readings(i, k) = static_cast<double>(readings[static_cast<std::size_t>(k)]);
    }
    s.d[i] = static_cast<double>(d);
    s.exx[i] = static_cast<double>(e.exx);
    const long double truth[] = {e.eax, e.ebx, e.ecx, e.eyx, e.ezx, e.exx};
    for (Index k = 0; k < 6; ++k) s.truth(i, k) = static_cast<double>(truth[k]);
  }
  return s;
}

PerProbe<> ReadingsAt(const Stations& s, Index i) {
  return {s.readings(i, 0), s.readings(i, 1), s.readings(i, 2), s.readings(i, 3), s.readings(i, 4)};
}

double WorstAngle(const Errors& a, const Errors& b) {
  return (a - b).leftCols<3>().cwiseAbs().maxCoeff();
}
double WorstTranslation(const Errors& a, const Errors& b) {
  return (a - b).middleCols<2>(3).cwiseAbs().maxCoeff();
}

TEST(HeadInversionBatch, IsThatOfSingleStationsToRounding) {
  for (const MovingBody moving : {MovingBody::kTarget, MovingBody::kHead}) {
    const Stations s = Drawn(moving, 3001);
    const SmallAngleInversion invert(NominalLayout(), moving);
    Errors single(3001, 6);
    for (Index i = 0; i < single.rows(); ++i) {
      const auto e = invert(ReadingsAt(s, i), s.d[i], s.exx[i]);
      single.row(i) << e.eax, e.ebx, e.ecx, e.eyx, e.ezx, e.exx;
    }
    test::OnEachWidth([&] {
      Errors errors;
      invert.Invert(s.readings, s.d, s.exx, errors);
      EXPECT_LT(WorstAngle(errors, single), 4 * kEps * kOverArm);
      EXPECT_LT(WorstTranslation(errors, single), 4 * kEps * kReading);
      EXPECT_EQ(errors.col(5), s.exx);
      // The readings are rounded too.
      EXPECT_LT(WorstAngle(errors, s.truth), 8 * kEps * kOverArm);
      EXPECT_LT(WorstTranslation(errors, s.truth), 8 * kEps * kReading);
    });
  }
}

TEST(HeadInversionBatch, DoesNotDependOnTheNumberOfStationsNorOnTheirPlace) {
  const Stations s = Drawn(MovingBody::kTarget, 200);
  const SmallAngleInversion invert(NominalLayout(), MovingBody::kTarget);
  test::OnEachWidth([&] {
    Errors all, some;
    invert.Invert(s.readings, s.d, Eigen::VectorXd(), all);
    EXPECT_EQ(all.col(5).norm(), 0);
    for (const Index first : {0, 1, 5}) {
      for (const Index count : {0, 1, 2, 3, 4, 5, 7, 8, 9, 17, 63, 64, 65, 127, 128, 130}) {
        invert.Invert(s.readings.middleRows(first, count), s.d.segment(first, count),
                      Eigen::VectorXd(), some);
        ASSERT_EQ(some.rows(), count);
        if (count == 0) continue;
        EXPECT_LT(WorstAngle(some, all.middleRows(first, count)), 4 * kEps * kOverArm);
        EXPECT_LT(WorstTranslation(some, all.middleRows(first, count)), 4 * kEps * kReading);
      }
    }
  });
}

template <typename Action>
std::string RefusalOf(const Action& action) {
  try {
    action();
  } catch (const NumericalError& error) {
    return error.what();
  }
  return "";
}

TEST(HeadInversionBatch, RefusesWhatIsRefusedOfASingleStation) {
  for (const MovingBody moving : {MovingBody::kTarget, MovingBody::kHead}) {
    const Stations s = Drawn(moving, 75);
    const SmallAngleInversion invert(NominalLayout(), moving);
    for (const double strange :
         {std::nan(""), std::numeric_limits<double>::infinity(), 1e3, -1e300}) {
      for (const Index at : {0, 6, 63, 64, 74}) {
        Stations wrong = s;
        wrong.readings(at, at % 5) = strange;
        const auto single = [&] { invert(ReadingsAt(wrong, at), wrong.d[at], wrong.exx[at]); };
        const std::string expected = RefusalOf(single);
        EXPECT_NE(expected, "") << strange;
        test::OnEachWidth([&] {
          Errors errors;
          EXPECT_EQ(RefusalOf([&] { invert.Invert(wrong.readings, wrong.d, wrong.exx, errors); }),
                    expected);
        });
      }
    }
  }
}

TEST(HeadInversionBatch, RefusesColumnsOfDifferentLengths) {
  const Stations s = Drawn(MovingBody::kTarget, 5);
  const SmallAngleInversion invert(NominalLayout(), MovingBody::kTarget);
  Errors errors;
  EXPECT_THROW(invert.Invert(s.readings, s.d.head(4), s.exx, errors), InputError);
  EXPECT_THROW(invert.Invert(s.readings, s.d, s.exx.head(4), errors), InputError);
}

TEST(HeadInversionOfRows, GivesBackTheErrorsOfTheReadings) {
  for (const MovingBody moving : {MovingBody::kTarget, MovingBody::kHead}) {
    const SmallAngleInversion invert(NominalLayout(), moving);
    for (const Index count : {0, 1, 255, 256, 257, 3001}) {
      const Stations s = Drawn(moving, count);
      const ReadingRows readings = s.readings.transpose();
      ErrorRows errors(6, count), without(6, count);
      InvertRows(invert, readings, s.d, s.exx, errors);
      InvertRows(invert, readings, s.d, Eigen::VectorXd(), without);
      if (count == 0) continue;
      EXPECT_LT(WorstAngle(errors.transpose(), s.truth), 8 * kEps * kOverArm);
      EXPECT_LT(WorstTranslation(errors.transpose(), s.truth), 8 * kEps * kReading);
      EXPECT_EQ(errors.row(5).transpose(), s.exx);
      EXPECT_EQ(without.row(5).norm(), 0);
    }
  }
}

TEST(HeadInversionOfRows, RefusesTheFirstOfThoseThatAreRefused) {
  const Stations s = Drawn(MovingBody::kTarget, 600);
  const SmallAngleInversion invert(NominalLayout(), MovingBody::kTarget);
  ReadingRows readings = s.readings.transpose();
  readings(2, 301) = 1e3;
  readings(1, 599) = std::nan("");
  const PerProbe<> first{readings(0, 301), readings(1, 301), 1e3, readings(3, 301),
                         readings(4, 301)};
  ErrorRows errors(6, 600);
  const std::string refused =
      RefusalOf([&] { InvertRows(invert, readings, s.d, Eigen::VectorXd(), errors); });
  EXPECT_EQ(refused, RefusalOf([&] { invert(first, s.d[301]); }));
  EXPECT_NE(refused, "");
}

TEST(HeadInversionOfRows, RefusesRowsOfDifferentLengths) {
  const Stations s = Drawn(MovingBody::kTarget, 5);
  const SmallAngleInversion invert(NominalLayout(), MovingBody::kTarget);
  const ReadingRows readings = s.readings.transpose();
  ErrorRows errors(6, 5), short_of(6, 4);
  EXPECT_THROW(InvertRows(invert, readings, s.d.head(4), s.exx, errors), InputError);
  EXPECT_THROW(InvertRows(invert, readings, s.d, s.exx.head(4), errors), InputError);
  EXPECT_THROW(InvertRows(invert, readings, s.d, s.exx, short_of), InputError);
}

}  // namespace head_inversion_batch_test
}  // namespace abbe::probes
