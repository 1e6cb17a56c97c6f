#include "machine/error_function.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "failure/failure.h"
#include "machine/tanh_network.h"
#include "volumetric_cases.h"

namespace abbe::machine {
namespace error_function_test {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr Travel kTravel{-0.02, 0.06};
constexpr double kLength = 0.08;
constexpr int kEyx = 1, kEbx = 4, kExx = 0;  // motions

std::vector<SharedForm> AllForms() {
  return {MakeBSplineForm(geometry::BSplineBasis::Uniform(3, -0.02, 0.06, 8)),
          MakeTableForm({-0.02, -0.01, 0.013, 0.04, 0.06}),
          MakePolynomialForm(5, -0.02, 0.06),
          MakeFourierForm(3, 0.01),
          MakeTanhNetwork(4, 2 / kLength, NetworkBias::kAsPrinted),
          MakeTanhNetwork(4, 2 / kLength, NetworkBias::kWithBias)};
}

Eigen::VectorXd Coefficients(int size, std::uint64_t seed) {
  Numbers numbers(seed);
  Eigen::VectorXd c(size);
  for (double& value : c) value = numbers.Next();
  return c;
}

ErrorFunction Drawn(int motion, const SharedForm& form, std::uint64_t seed) {
  ErrorFunction function(0, motion, form, kTravel);
  function.SetCoefficients(Coefficients(form->size(), seed));
  return function;
}

// The slope of the least-squares line over the travel, by the midpoint rule on cells that no kink
// of AllForms() falls into (80 cells to the mm, kinks at whole mm); error kLength^2/24/n^2 f''.
double LineSlope(const ErrorFunction& function) {
  constexpr int kCells = 6400;
  double product = 0.0, square = 0.0;
  for (int i = 0; i < kCells; ++i) {
    const double u = kLength * ((i + 0.5) / kCells - 0.5);
    product += u * function.Evaluate(0.02 + u);
    square += u * u;
  }
  return product / square;
}

TEST(ErrorFunction, IsZeroAtTheFirstEndOfTheTravelInEveryForm) {
  for (const SharedForm& form : AllForms()) {
    for (const int motion : {kExx, kEyx, kEbx}) {
      EXPECT_LT(std::abs(Drawn(motion, form, 3).Evaluate(kTravel.first)), 16 * kEps)
          << form->Name() << motion;
    }
  }
}

TEST(ErrorFunction, AStraightnessHasNoLinearPartInAnyForm) {
  for (const SharedForm& form : AllForms()) {
    // Values of size 1 over 0.08 m; the midpoint rule leaves f'' h^2 / 24: up to 1e-4 of a slope of
    // 12 for the waves of 3.3 mm.
    EXPECT_LT(std::abs(LineSlope(Drawn(kEyx, form, 3))), 2e-3) << form->Name();
    EXPECT_GT(std::abs(LineSlope(Drawn(kExx, form, 3))), 1e-2) << form->Name();
  }
}

// The gauge takes no more than a line and a constant: what is left differs from the raw form by
// exactly those, seen on the second differences.
TEST(ErrorFunction, TheGaugeTakesOnlyALineAway) {
  for (const SharedForm& form : AllForms()) {
    const ErrorFunction function = Drawn(kEyx, form, 5);
    const Eigen::VectorXd c = Coefficients(form->size(), 5);
    const auto bend = [](const auto& f) { return f(0.0) - 2 * f(0.017) + f(0.034); };
    const double raw =
        bend([&](double x) { return form->Evaluate(x, c.data(), nullptr, nullptr); });
    EXPECT_NEAR(bend([&](double x) { return function.Evaluate(x); }), raw, 64 * kEps)
        << form->Name();
  }
}

// Closed forms: over u = -1 ... 1, T_2 = 2 u^2 - 1 has no slope; T_3 = 4 u^3 - 3 u has -3/5.
TEST(ErrorFunction, APolynomialLosesTheSlopeThatLegendreFinds) {
  ErrorFunction eyx(0, kEyx, MakePolynomialForm(3, kTravel.first, kTravel.last), kTravel);
  eyx.SetCoefficients(Eigen::Vector4d(0.3, 0.7, 2.0, 5.0));
  for (const double u : {-1.0, -0.3, 0.2, 1.0}) {
    const auto f = [](double v) {
      return 2.0 * (2 * v * v - 1) + 5.0 * (4 * v * v * v - 3 * v + 0.6 * v);
    };
    EXPECT_NEAR(eyx.Evaluate(0.02 + 0.04 * u), f(u) - f(-1.0), 64 * kEps);
  }
}

TEST(ErrorFunction, ATableIsMetAtItsPositionsAndStraightBetween) {
  ErrorFunction exx(0, kExx, MakeTableForm({-0.02, 0.01, 0.06}), kTravel);
  exx.SetCoefficients(Eigen::Vector3d(1.0, 3.0, 2.0));
  EXPECT_NEAR(exx.Evaluate(0.01), 2.0, 8 * kEps);
  EXPECT_NEAR(exx.Evaluate(0.06), 1.0, 8 * kEps);
  EXPECT_NEAR(exx.Evaluate(-0.005), 1.0, 8 * kEps);
}

TEST(ErrorFunction, AFourierSeriesRepeatsWithItsPeriod) {
  const ErrorFunction exx = Drawn(kExx, MakeFourierForm(3, 0.01), 9);
  EXPECT_NEAR(exx.Evaluate(0.003), exx.Evaluate(0.023), 256 * kEps);
  ErrorFunction sine(0, kExx, MakeFourierForm(1, 0.01), kTravel);
  sine.SetCoefficients(Eigen::Vector2d(1.0, 0.0));
  EXPECT_NEAR(sine.Evaluate(0.0025), 1.0, 64 * kEps);
}

TEST(ErrorFunction, TheNetworkAsPrintedIsOddAndTheOneWithBiasIsNot) {
  const auto unevenness = [](NetworkBias bias) {
    const SharedForm form = MakeTanhNetwork(4, 25.0, bias);
    const Eigen::VectorXd c = Coefficients(form->size(), 2);
    const auto f = [&](double x) { return form->Evaluate(x, c.data(), nullptr, nullptr); };
    return std::abs(f(0.015) + f(-0.015));
  };
  EXPECT_LT(unevenness(NetworkBias::kAsPrinted), 8 * kEps);
  EXPECT_GT(unevenness(NetworkBias::kWithBias), 0.1);
}

TEST(ErrorFunction, SlopeAndGradientAreThoseOfFiniteDifferencesInEveryForm) {
  // Waves of 3.3 mm: f''' is at most (2 pi / 3.3 mm)^3 = 7e9, for the others below 1e6.
  for (const SharedForm& form : AllForms()) {
    for (const int motion : {kExx, kEyx}) {
      ErrorFunction function = Drawn(motion, form, 4);
      const Eigen::VectorXd c = function.coefficients();
      const double x = 0.0237, hx = 1e-7;
      double slope = 0.0;
      Eigen::VectorXd gradient(c.size());
      function.Evaluate(x, &slope, gradient.data());
      EXPECT_NEAR(slope, (function.Evaluate(x + hx) - function.Evaluate(x - hx)) / (2 * hx),
                  hx * hx / 6 * 4 * 7e9 + 16 * kEps / hx)
          << form->Name();
      const double hc = 1e-5;  // third derivatives by c of size 10: hc^2 / 6 * 10, and eps / hc
      for (Eigen::Index i = 0; i < c.size(); ++i) {
        const auto at = [&](double step) {
          function.SetCoefficients(c + step * Eigen::VectorXd::Unit(c.size(), i));
          return function.Evaluate(x);
        };
        EXPECT_NEAR(gradient[i], (at(hc) - at(-hc)) / (2 * hc), hc * hc / 6 * 10 + 32 * kEps / hc)
            << form->Name() << " " << i;
      }
    }
  }
}

TEST(ErrorFunction, WithoutAFormIsZeroEverywhere) {
  double slope = 1.0;
  EXPECT_EQ(ErrorFunction().Evaluate(0.3, &slope), 0.0);
  EXPECT_EQ(slope, 0.0);
}

template <typename Action>
std::string MessageOf(const Action& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no failure";
}

TEST(ErrorFunction, RefusesAPositionOutsideTheTravel) {
  for (const SharedForm& form : AllForms()) {
    const ErrorFunction function = Drawn(kEyx, form, 1);
    EXPECT_THAT(MessageOf([&] { function.Evaluate(0.061); }),
                testing::HasSubstr("X = 61 mm lies outside its travel, -20 to 60 mm"));
    EXPECT_THROW(function.Evaluate(std::nan("")), InputError);
    EXPECT_NO_THROW(function.Evaluate(0.06 * (1 + kEps)));
  }
}

TEST(ErrorFunction, RefusesWrongCoefficientsAndForms) {
  ErrorFunction eyx(0, kEyx, MakeFourierForm(2, 0.01), kTravel);
  EXPECT_THAT(MessageOf([&] { eyx.SetCoefficients(Eigen::Vector3d::Zero()); }),
              testing::HasSubstr("3 coefficients for EYX, which has 4"));
  EXPECT_THAT(MessageOf([&] { eyx.SetCoefficients(Eigen::Vector4d(0, 0, NAN, 0)); }),
              testing::HasSubstr("a coefficient of EYX is not a finite number"));
  EXPECT_THROW(ErrorFunction(0, 0, MakeFourierForm(2, 0.01), {0.01, 0.01}), InputError);
  EXPECT_THROW(MakeTableForm({0.0}), InputError);
  EXPECT_THROW(MakeTableForm({0.0, 0.0}), InputError);
  EXPECT_THROW(MakePolynomialForm(31, 0.0, 1.0), InputError);
  EXPECT_THROW(MakePolynomialForm(3, 1.0, 1.0), InputError);
  EXPECT_THROW(MakeFourierForm(0, 1.0), InputError);
  EXPECT_THROW(MakeFourierForm(1, 0.0), InputError);
  EXPECT_THROW(MakeTanhNetwork(0, 1.0, NetworkBias::kWithBias), InputError);
  EXPECT_THROW(MakeTanhNetwork(1, 0.0, NetworkBias::kWithBias), InputError);
  // A basis that ends before the travel does.
  EXPECT_THROW(
      ErrorFunction(0, 0, MakeBSplineForm(geometry::BSplineBasis::Uniform(3, 0, 1, 8)), kTravel),
      InputError);
}

}  // namespace error_function_test
}  // namespace abbe::machine
