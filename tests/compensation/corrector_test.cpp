#include "compensation/corrector.h"

#include "failure/failure.h"
#include "map_cases.h"

namespace abbe::compensation {
namespace corrector_test {

using Eigen::Vector3d;
using map::ErrorMap;

// Inside by more than the correction, which is below 0.1 mm.
Vector3d Inside(const ErrorMap& map, std::uint64_t seed, std::uint64_t i) {
  const Vector3d middle(0.03, 0.03, 0.03);
  return middle + 0.99 * (map::RandomPlace(map, seed, i) - middle);
}

TEST(Corrector, ACorrectedCommandBringsTheToolWhereItShouldBeForAnyChain) {
  const Vector3d tool(0.02, -0.03, -0.15);
  for (const char* const chain : {map::kColumn, map::kBridge, "[w Z b X Y t]", "[w X Y Z b t]"}) {
    const ErrorMap map = map::RandomMap(3, chain);
    const Corrector corrector(map, tool);
    double largest = 0.0;
    for (int i = 0; i < 200; ++i) {
      const Vector3d wanted = Inside(map, 1, i);
      const Vector3d command = corrector.Command(wanted);
      // Rounding: some dozen operations on lengths of 0.2 m.
      EXPECT_LT((corrector.Made(command) - wanted).norm(), 1e-15);
      // In the workpiece, where it counts: nominal + error of the command = nominal of the wanted.
      const auto errors = map.model().Motions(command);
      EXPECT_LT((machine::ToolInWork<double>(map.model().chain(), command, tool, errors) -
                 machine::NominalToolInWork<double>(map.model().chain(), wanted, tool))
                    .norm(),
                1e-15);
      largest = std::max(largest, (command - wanted).norm());
    }
    EXPECT_GT(largest, 5e-6);
  }
}

TEST(Corrector, IsBetterThanTheFirstStepAlone) {
  const ErrorMap map = map::RandomMap(3);
  const Corrector corrector(map, Vector3d::Zero());
  double first_order = 0.0, iterated = 0.0;
  for (int i = 0; i < 100; ++i) {
    const Vector3d wanted = Inside(map, 1, i);
    const Vector3d once = 2 * wanted - corrector.Made(wanted);
    first_order = std::max(first_order, (corrector.Made(once) - wanted).norm());
    iterated = std::max(iterated, (corrector.Made(corrector.Command(wanted)) - wanted).norm());
  }
  EXPECT_GT(first_order, 1e-9);
  EXPECT_LT(iterated, 1e-6 * first_order);
}

// The machine differs from its map as the map's covariance says; correcting by the map then leaves
// what the map states as its own uncertainty. 300 machines: the rms of the residuals, of which each
// machine has some five independent ones, is known to 2 %.
TEST(Corrector, WhatIsLeftIsTheMapsOwnUncertainty) {
  const ErrorMap map = map::RandomMap(8);
  const Vector3d tool = map.origin().tool;
  const Corrector corrector(map, tool);
  std::vector<Vector3d> wanted, commands;
  double stated = 0.0, before = 0.0;
  for (int i = 0; i < 60; ++i) {
    wanted.push_back(Inside(map, 2, i));
    commands.push_back(corrector.Command(wanted.back()));
    stated += map.Covariance(wanted.back(), tool).trace();
  }
  double left = 0.0;
  machine::VolumetricModel drawn = map.model();
  constexpr int kMachines = 300;
  for (int machine = 0; machine < kMachines; ++machine) {
    drawn.SetParameters(map::DrawParameters(map, 500 + machine));
    const Corrector truth(drawn, tool);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      left += (truth.Made(commands[i]) - wanted[i]).squaredNorm();
      before += (truth.Made(wanted[i]) - wanted[i]).squaredNorm();
    }
  }
  const double ratio = std::sqrt(left / kMachines / stated);
  EXPECT_LT(ratio, 1.1);
  EXPECT_GT(ratio, 0.9);
  EXPECT_GT(std::sqrt(before / left), 3.0);
}

// A place beyond the travel is refused; the command for a place at its end may lie a little beyond,
// as far as the soft limits: the errors there are those at the end.
TEST(Corrector, ACommandMayLieBeyondTheTravelButNotBeyondTheSoftLimits) {
  const ErrorMap map = map::RandomMap(3);
  const Corrector corrector(map, Vector3d::Zero());
  const Corrector hard(map.model(), Vector3d::Zero(), map.model().travels());
  map::ExpectHas(map::MessageOf<InputError>([&] {
                   corrector.Command({0.0601, 0.01, 0.01});
                 }),
                 "outside its travel");
  const Vector3d signs = map.model().chain().ToolSenses();
  int beyond = 0;
  for (const double z : {0.0, 0.06}) {
    for (const double y : {0.0, 0.06}) {
      for (const double x : {0.0, 0.06}) {
        const Vector3d corner(x, y, z);
        const Vector3d command = corrector.Command(corner);
        const Vector3d inside = command.cwiseMax(0.0).cwiseMin(0.06);
        EXPECT_LT(
            (command + signs.cwiseProduct(map.Error(inside, Vector3d::Zero())) - corner).norm(),
            1e-12);
        if (inside == command) {
          EXPECT_EQ(hard.Command(corner), command);
          continue;
        }
        ++beyond;
        const std::string refused = map::MessageOf<InputError>([&] { hard.Command(corner); });
        map::ExpectHas(refused, "is beyond the soft limits, 0 to 60 mm");
        map::ExpectHas(refused, "limit_mm in [axis.");
        EXPECT_LT((corrector.MadeOfReading(command) - corner).norm(), 1e-12);
      }
    }
  }
  EXPECT_GT(beyond, 0);  // at the corners half of all corrections point outside
}

// A zero that was touched off stands where the tool was: kept, nothing moves there, and a place
// elsewhere has the same distance to it on the real machine as in the program.
TEST(Corrector, AKeptZeroStaysAndAllElseIsRightAgainstIt) {
  for (const char* const chain : {map::kColumn, map::kBridge}) {
    const ErrorMap map = map::RandomMap(8, chain);
    const Vector3d tool(0.05, -0.1, -0.4), zero(0.03, 0.02, 0.01), place(0.05, 0.04, 0.05);
    Corrector corrector(map, tool);
    EXPECT_GT((corrector.Command(zero) - zero).norm(), 3e-6);
    corrector.KeepZero(zero);
    EXPECT_EQ(corrector.Command(zero), zero);
    EXPECT_EQ(corrector.Made(zero), zero);
    const auto real = [&](const Vector3d& axes) -> Vector3d {
      return machine::NominalToolInWork<double>(map.model().chain(), axes, tool) +
             map.Error(axes, tool);
    };
    const Vector3d meant = map.model().chain().ToolSenses().cwiseProduct(place - zero);
    EXPECT_LT((real(corrector.Command(place)) - real(zero) - meant).norm(), 1e-11);
  }
}

// Whichever tool is in the spindle: each is taken to have touched the zero itself.
TEST(Corrector, AKeptZeroMovesWithNoTool) {
  const ErrorMap map = map::RandomMap(8);
  const Vector3d zero(0.03, 0.02, 0.01), longer(0.0, 0.0, -0.15);
  Corrector corrector(map, Vector3d::Zero());
  const Vector3d before = corrector.Made(zero);
  corrector.SetTool(longer);
  EXPECT_GT((corrector.Made(zero) - before).norm(), 1e-6);  // the angles act at its length
  corrector.KeepZero(zero);
  for (const double length : {0.0, -0.05, -0.15}) {
    corrector.SetTool({0.0, 0.0, length});
    EXPECT_EQ(corrector.Command(zero), zero) << length;
  }
}

TEST(Corrector, AMapWithoutInverseIsANumericalError) {
  machine::VolumetricModel model(machine::Chain::Parse(map::kBridge), {{{0, 1}, {0, 1}, {0, 1}}});
  // 0.2 m of sine over 1 m: a slope of 1.26 at the middle, about which the iteration swings.
  model.SetForm(0, 0, machine::MakeFourierForm(1, 1.0));
  model.SetCoefficients(0, 0, Eigen::Vector2d(-0.2, 0.0));
  EXPECT_THROW(Corrector(model, Vector3d::Zero()).Command({0.48, 0.5, 0.5}), NumericalError);
}

TEST(Corrector, LinesOfTheStatedLengthStayWithinTheTolerance) {
  const ErrorMap map = map::RandomMap(5);
  const Corrector corrector(map, Vector3d::Zero());
  constexpr double kTolerance = 0.1e-6;
  const double length = LineLength(corrector, map.model(), kTolerance);
  EXPECT_GT(length, 0.5e-3);
  double worst = 0.0;
  for (int i = 0; i < 500; ++i) {
    const Vector3d a = Inside(map, 4, i);
    const Vector3d b = a + length * (Vector3d(0.03, 0.03, 0.03) - a).normalized();
    const Vector3d chord = (corrector.Command(a) + corrector.Command(b)) / 2;
    worst = std::max(worst, (chord - corrector.Command((a + b) / 2)).norm());
  }
  // The curvature is taken along seven lines only; elsewhere it may be somewhat larger.
  EXPECT_LT(worst, 3 * kTolerance);
  EXPECT_GT(worst, 0.3 * kTolerance);
}

}  // namespace corrector_test
}  // namespace abbe::compensation
