#include "machine/volumetric_field.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "failure/failure.h"
#include "machine/configurations.h"
#include "machine/tanh_network.h"
#include "volumetric_cases.h"

namespace abbe::machine {
namespace volumetric_field_test {

using Eigen::Vector3d;

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr std::array<Travel, 3> kTravels = {{{0.0, 0.5}, {0.0, 0.4}, {-0.3, 0.0}}};
constexpr double kSize = 1e-4;            // of every coefficient
constexpr double kRounding = 1e4 * kEps;  // the condition of the powers of t up to the sixth
const Vector3d kTool(0.05, -0.04, 0.1);

// Every form somewhere, each on pieces of its own.
VolumetricModel AnyMachine(const Chain& chain) {
  VolumetricModel model(chain, kTravels);
  for (int axis = 0; axis < kAxes; ++axis) {
    const auto [first, last] = kTravels[static_cast<std::size_t>(axis)];
    const SharedForm forms[] = {
        MakeBSplineForm(geometry::BSplineBasis::Uniform(3, first, last, 7)),
        MakeBSplineForm(geometry::BSplineBasis::Uniform(5, first, last, 12)),
        MakePolynomialForm(6, first, last),
        MakeTableForm({first, first + 0.1, last}),
        MakeFourierForm(2, 0.3),
        MakeTanhNetwork(3, 5.0, NetworkBias::kWithBias)};
    for (int motion = 0; motion < kMotions; ++motion) {
      model.SetForm(axis, motion, forms[(motion + axis) % kMotions]);
    }
  }
  Numbers numbers(11);
  Eigen::VectorXd p(model.ParameterCount());
  for (double& value : p) value = kSize * numbers.Next();
  model.SetParameters(p);
  return model;
}

Vector3d Place(Numbers& numbers) {
  Vector3d place;
  for (int k = 0; k < 3; ++k) {
    const Travel& travel = kTravels[static_cast<std::size_t>(k)];
    place[k] = travel.first + (travel.last - travel.first) * (numbers.Next() + 1) / 2;
  }
  return place;
}

TEST(AxisMotions, AreTheFunctionsOfTheAxisAtKnotsEndsAndBetween) {
  const VolumetricModel model = AnyMachine(ChainOf("column"));
  for (int axis = 0; axis < kAxes; ++axis) {
    std::array<ErrorFunction, kMotions> functions;
    for (int motion = 0; motion < kMotions; ++motion) {
      functions[static_cast<std::size_t>(motion)] = model.Function(axis, motion);
    }
    const auto [first, last] = kTravels[static_cast<std::size_t>(axis)];
    const AxisMotions motions(axis, functions, {first, last});
    std::vector<double> places = {first, last, first + 0.1};
    for (int i = 1; i < 4; ++i) places.push_back(first + (last - first) * i / 4);
    for (int i = 0; i < 1000; ++i) places.push_back(first + (last - first) * (i + 0.37) / 1000);
    for (const double x : places) {
      const auto errors = motions.At(x);
      for (int motion = 0; motion < kMotions; ++motion) {
        EXPECT_NEAR(errors[motion], functions[static_cast<std::size_t>(motion)].Evaluate(x),
                    kSize * kRounding)
            << MotionName(axis, motion) << " at " << x;
      }
    }
  }
}

TEST(VolumetricField, IsItsModelOnEveryChainHoweverItCounts) {
  for (const Chain& chain : AllCounts()) {
    const VolumetricModel model = AnyMachine(chain);
    const VolumetricField field(model);
    Numbers numbers(5);
    Eigen::Matrix3Xd places(3, 50);
    for (int i = 0; i < 50; ++i) places.col(i) = Place(numbers);
    places.row(1).segment(10, 20).setConstant(0.2);  // an axis that stands still
    const Eigen::Matrix3Xd errors = field.Errors(places, kTool);
    for (int i = 0; i < 50; ++i) {
      const Vector3d expected = model.Error(places.col(i), kTool);
      EXPECT_LT((errors.col(i) - expected).norm(), 16 * kEps) << chain.Text();
      EXPECT_EQ(errors.col(i), field.Error(places.col(i), kTool));
    }
  }
}

TEST(VolumetricField, RefusesWhatLiesOutsideAndTakesARoundedEnd) {
  const VolumetricField field(AnyMachine(ChainOf("column")));
  try {
    field.Error({0.1, 0.401, -0.1}, kTool);
    FAIL() << "extrapolated";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                testing::HasSubstr("Y = 401 mm lies outside its travel, 0 to 400 mm"));
  }
  EXPECT_THROW(field.Error({0.1, 0.2, std::nan("")}, kTool), InputError);
  EXPECT_THROW(VolumetricField(VolumetricModel(ChainOf("column"), kTravels))
                   .Errors(Vector3d(0.0, 0.0, 1.0), kTool),
               InputError);
  EXPECT_NO_THROW(field.Error({0.5 * (1 + 2 * kEps), 0.4, -0.3}, kTool));
}

}  // namespace volumetric_field_test
}  // namespace abbe::machine
