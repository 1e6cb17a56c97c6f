#include "machine/volumetric_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "failure/failure.h"
#include "machine/configurations.h"
#include "machine/tanh_network.h"
#include "volumetric_cases.h"

namespace abbe::machine {
namespace volumetric_model_test {

using Eigen::Vector3d;

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr std::array<Travel, 3> kTravels = {{{0.0, 0.5}, {0.0, 0.4}, {-0.3, 0.0}}};

// Every form somewhere, each of the 18 functions with one.
VolumetricModel AnyMachine(const Chain& chain) {
  VolumetricModel model(chain, kTravels);
  for (int axis = 0; axis < kAxes; ++axis) {
    const auto [first, last] = kTravels[axis];
    const SharedForm forms[] = {MakeBSplineForm(geometry::BSplineBasis::Uniform(3, first, last, 7)),
                                MakePolynomialForm(4, first, last),
                                MakeFourierForm(2, 0.3),
                                MakeTableForm({first, first + 0.1, last}),
                                MakeTanhNetwork(3, 5.0, NetworkBias::kWithBias),
                                MakeTanhNetwork(3, 5.0, NetworkBias::kAsPrinted)};
    for (int motion = 0; motion < kMotions; ++motion) {
      model.SetForm(axis, motion, forms[(motion + axis) % kMotions]);
    }
  }
  return model;
}

Eigen::VectorXd Drawn(Eigen::Index size, double scale) {
  Numbers numbers(11);
  Eigen::VectorXd p(size);
  for (double& value : p) value = scale * numbers.Next();
  return p;
}

TEST(VolumetricModel, APerfectMachineErrsNowhere) {
  const VolumetricModel model(ChainOf("column"), kTravels);
  EXPECT_LT(model.Error({0.31, 0.17, -0.23}, {0.1, 0.2, 0.3}).norm(), 8 * kEps);
  EXPECT_EQ(model.ParameterCount(), 3);
}

TEST(VolumetricModel, DerivativesAreThoseOfFiniteDifferences) {
  const Vector3d position(0.31, 0.17, -0.23), p_TQ(0.05, -0.04, 0.1);
  const double h = 1e-5;  // third derivatives below 100 (waves of 0.15 m: 42^3 * 1e-2)
  const double tolerance = h * h / 6 * 1e3 + 64 * kEps / h;
  for (const Configuration& configuration : kConfigurations) {
    VolumetricModel model = AnyMachine(Chain::Parse(configuration.chain));
    const Eigen::VectorXd p = Drawn(model.ParameterCount(), 1e-2);
    model.SetParameters(p);
    const auto linear = model.Linearize(position, p_TQ);
    EXPECT_LT((linear.error - model.Error(position, p_TQ)).norm(), 16 * kEps);
    const auto near = [&](const auto& at, const Vector3d& derivative) {
      return ((at(h) - at(-h)) / (2 * h) - derivative).norm() < tolerance;
    };
    for (int i = 0; i < 3; ++i) {
      const Vector3d step = Vector3d::Unit(i);
      EXPECT_TRUE(near([&](double s) { return model.Error(position + s * step, p_TQ); },
                       linear.J_error_position.col(i)));
      EXPECT_TRUE(near([&](double s) { return model.Error(position, p_TQ + s * step); },
                       linear.J_error_tool.col(i)));
    }
    for (Eigen::Index i = 0; i < p.size(); ++i) {
      EXPECT_TRUE(near(
          [&](double s) -> Vector3d {
            model.SetParameters(p + s * Eigen::VectorXd::Unit(p.size(), i));
            return model.Error(position, p_TQ);
          },
          linear.J_error_parameters.col(i)))
          << configuration.name << " parameter " << i;
    }
  }
}

TEST(VolumetricModel, ParametersReturnAsTheyWereSetAndBlocksNameThem) {
  VolumetricModel model = AnyMachine(ChainOf("gantry"));
  const Eigen::VectorXd p = Drawn(model.ParameterCount(), 1e-4);
  model.SetParameters(p);
  EXPECT_EQ(model.Parameters(), p);
  Eigen::Index at = 0;
  for (const auto& block : model.Blocks()) {
    EXPECT_EQ(block.Values(), p.segment(at, block.size())) << block.name;
    at += block.size();
  }
  EXPECT_EQ(at, p.size());
  EXPECT_EQ(model.Blocks()[4].name, "EBX");
  EXPECT_EQ(model.Blocks().back()["C0Y"].value, p[p.size() - 1]);
}

TEST(VolumetricModel, ABatchIsItsPoints) {
  VolumetricModel model = AnyMachine(ChainOf("fixed-bridge"));
  model.SetParameters(Drawn(model.ParameterCount(), 1e-4));
  Eigen::Matrix3Xd positions(3, 3);
  positions << 0.0, 0.5, 0.2, 0.0, 0.4, 0.1, -0.3, 0.0, -0.1;
  const Eigen::Matrix3Xd errors = model.Errors(positions, Vector3d(0, 0, 0.1));
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT((errors.col(i) - model.Error(positions.col(i), Vector3d(0, 0, 0.1))).norm(),
              16 * kEps);
  }
}

TEST(VolumetricModel, RefusesWhatDoesNotExist) {
  VolumetricModel model = AnyMachine(ChainOf("column"));
  try {
    model.Error({0.1, 0.401, -0.1}, Vector3d::Zero());
    FAIL() << "extrapolated";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                testing::HasSubstr("Y = 401 mm lies outside its travel, 0 to 400 mm"));
  }
  EXPECT_THROW(VolumetricModel(ChainOf("column"), kTravels).Error({0, 0, 1}, Vector3d::Zero()),
               InputError);
  EXPECT_THROW(model.Linearize({0.1, 0.1, 0.1}, Vector3d::Zero()), InputError);
  EXPECT_THROW(model.Function(3, 0), InputError);
  EXPECT_THROW(model.SetForm(0, 6, MakeFourierForm(1, 1.0)), InputError);
  EXPECT_THROW(model.SetParameters(Eigen::VectorXd::Zero(5)), InputError);
  Eigen::VectorXd p = model.Parameters();
  p[p.size() - 1] = std::numeric_limits<double>::infinity();
  EXPECT_THROW(model.SetParameters(p), InputError);
}

}  // namespace volumetric_model_test
}  // namespace abbe::machine
