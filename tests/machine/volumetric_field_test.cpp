#include "machine/volumetric_field.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "failure/failure.h"
#include "machine/configurations.h"
#include "machine/tanh_network.h"
#include "machine/volumetric_jacobian.h"
#include "tests/each_width.h"
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

Eigen::Matrix3Xd Places(Eigen::Index count) {
  Numbers numbers(5);
  Eigen::Matrix3Xd places(3, count);
  for (Eigen::Index i = 0; i < count; ++i) places.col(i) = Place(numbers);
  return places;
}

TEST(VolumetricField, IsItsModelOnEveryChainHoweverItCounts) {
  Eigen::Matrix3Xd places = Places(50);
  places.row(1).segment(10, 20).setConstant(0.2);  // an axis that stands still
  for (const Chain& chain : AllCounts()) {
    const VolumetricModel model = AnyMachine(chain);
    const VolumetricField field(model);
    test::OnEachWidth([&] {
      const Eigen::Matrix3Xd errors = field.Errors(places, kTool);
      for (int i = 0; i < 50; ++i) {
        const Vector3d expected = model.Error(places.col(i), kTool);
        EXPECT_LT((errors.col(i) - expected).norm(), 16 * kEps) << chain.Text();
        EXPECT_LT((field.Error(places.col(i), kTool) - expected).norm(), 16 * kEps);
      }
    });
  }
}

// The motions are those of the model in double; the chain is computed with 64 bits of mantissa.
TEST(VolumetricField, IsTheProductOfTheRotationsInLongDouble) {
  const Eigen::Matrix3Xd places = Places(500);
  for (const Chain& chain : AllChains()) {
    const VolumetricModel model = AnyMachine(chain);
    const VolumetricField field(model);
    test::OnEachWidth([&] {
      const Eigen::Matrix3Xd errors = field.Errors(places, kTool);
      double worst = 0.0;
      for (Eigen::Index i = 0; i < places.cols(); ++i) {
        const MotionErrors<double> motions = model.Motions(places.col(i));
        MotionErrors<long double> exact;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          exact.axes[axis] = motions.axes[axis].cast<long double>();
        }
        exact.squareness = motions.squareness.cast<long double>();
        const auto truth = VolumetricError<long double>(chain, places.col(i).cast<long double>(),
                                                        kTool.cast<long double>(), exact);
        const double error =
            static_cast<double>((errors.col(i).cast<long double>() - truth).norm());
        worst = std::max(worst, error);
      }
      EXPECT_LT(worst, 16 * kEps) << chain.Text();
    });
  }
}

// The gradients of the model are those of VolumetricErrorAndJacobian, which another test holds to
// dual numbers.
void ExpectDerivatives(const VolumetricModel& model, const Eigen::Matrix3Xd& places, double size) {
  const double tolerance = 16 * kEps + 2 * size * kRounding;
  // A slope is the difference of values over a piece, of a centimetre or more; six are added.
  const double slope_tolerance = 6 * size * kRounding / 0.01;
  const VolumetricField field(model);
  test::OnEachWidth([&] {
    const auto linear = field.Linearize(places, kTool);
    ASSERT_EQ(linear.size(), places.cols());
    for (Eigen::Index i = 0; i < places.cols(); ++i) {
      const auto one = model.Linearize(places.col(i), kTool);
      const auto motions = VolumetricErrorAndJacobian(model.chain(), places.col(i), kTool,
                                                      model.Motions(places.col(i)));
      const auto far = [](const auto& a, const auto& b) { return (a - b).cwiseAbs().maxCoeff(); };
      EXPECT_LT(far(linear.error(i), one.error), tolerance);
      EXPECT_LT(far(linear.J_error_motions(i), motions.J_error_motions), tolerance);
      EXPECT_LT(far(linear.J_error_squareness(i), motions.J_error_squareness), tolerance);
      EXPECT_LT(far(linear.J_error_position(i), one.J_error_position), slope_tolerance);
      EXPECT_LT(far(linear.J_error_tool(i), one.J_error_tool), tolerance);
    }
  });
}

TEST(VolumetricField, HasTheDerivativesOfItsModelOnEveryChain) {
  for (const Chain& chain : AllCounts()) {
    SCOPED_TRACE(chain.Text());
    ExpectDerivatives(AnyMachine(chain), Places(37), kSize);
  }
}

TEST(VolumetricField, TurnsAsFarAsTheModelSays) {
  VolumetricModel model = AnyMachine(ChainOf("column"));
  model.SetParameters(1e4 * model.Parameters());  // up to some radians
  const Eigen::Matrix3Xd places = Places(70);
  ExpectDerivatives(model, places, 1e4 * kSize);
  test::OnEachWidth([&] {
    const Eigen::Matrix3Xd errors = VolumetricField(model).Errors(places, kTool);
    for (Eigen::Index i = 0; i < places.cols(); ++i) {
      EXPECT_LT((errors.col(i) - model.Error(places.col(i), kTool)).norm(),
                1e4 * kSize * kRounding);
    }
  });
}

// From none to more than two blocks.
TEST(VolumetricField, DoesNotDependOnTheNumberOfPointsNorOnTheirPlace) {
  const VolumetricField field(AnyMachine(ChainOf("column")));
  const Eigen::Matrix3Xd places = Places(80);
  test::OnEachWidth([&] {
    const Eigen::Matrix3Xd all = field.Errors(places, kTool);
    const auto all_linear = field.Linearize(places, kTool);
    VolumetricField::Linearized linear;
    for (const Eigen::Index first : {0, 1, 3}) {
      for (const Eigen::Index count : {0, 1, 2, 3, 4, 5, 7, 8, 9, 15, 16, 17, 31, 32, 33, 65}) {
        const auto some = places.middleCols(first, count);
        EXPECT_EQ(field.Errors(some, kTool), all.middleCols(first, count));
        field.Linearize(some, kTool, linear);
        ASSERT_EQ(linear.size(), count);
        for (Eigen::Index i = 0; i < count; ++i) {
          EXPECT_EQ(linear.error(i), all_linear.error(first + i));
          EXPECT_EQ(linear.J_error_motions(i), all_linear.J_error_motions(first + i));
          EXPECT_EQ(linear.J_error_position(i), all_linear.J_error_position(first + i));
        }
      }
    }
  });
}

TEST(VolumetricField, HasNoDerivativesByAnAxisThatTheMachineLacks) {
  VolumetricModel model(Chain::Parse("[w X b t]"), {{{0, 0.5}, {0, 0}, {0, 0}}});
  const SharedForm form = MakePolynomialForm(3, 0, 0.5);
  for (int motion = 0; motion < kMotions; ++motion) model.SetForm(0, motion, form);
  Numbers numbers(3);
  Eigen::VectorXd p(model.ParameterCount());
  for (double& value : p) value = kSize * numbers.Next();
  model.SetParameters(p);
  Eigen::Matrix3Xd places = Eigen::Matrix3Xd::Zero(3, 20);
  places.row(0).setLinSpaced(0, 0.5);
  ExpectDerivatives(model, places, kSize);
  EXPECT_EQ(VolumetricField(model).Linearize(places, kTool).J_error_motions(7).rightCols(12).norm(),
            0);
}

// Anywhere in a block, as single points are.
TEST(VolumetricField, RefusesOnePointOutsideAmongMany) {
  const VolumetricField field(AnyMachine(ChainOf("column")));
  test::OnEachWidth([&] {
    for (const double outside : {0.401, -1.0, std::nan(""), 1e300}) {
      for (const Eigen::Index at : {0, 7, 31, 32, 39}) {
        Eigen::Matrix3Xd places = Places(40);
        places(1, at) = outside;
        EXPECT_THROW(field.Errors(places, kTool), InputError);
        EXPECT_THROW(field.Linearize(places, kTool), InputError);
      }
    }
  });
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
