#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string>

#include "machine/volumetric_error.h"
#include "volumetric_cases.h"

namespace abbe::machine {
namespace volumetric_property_test {

using Eigen::Vector3d;

// Some hundred products and sums of numbers of size 1.
constexpr double kRounding = 256 * std::numeric_limits<double>::epsilon();

struct Case {
  Chain chain;
  Vector3d position, p_TQ;
  MotionErrors<double> errors;
};

// Positions and tools up to 1 m, translations up to 0.1 m and angles up to 0.3 rad: the laws are
// exact.
Case AnyCase() {
  static const std::vector<Chain> chains = AllChains();
  Numbers numbers(*rc::gen::arbitrary<std::uint64_t>());
  const Chain& chain = chains[*rc::gen::inRange<std::size_t>(0, chains.size())];
  return {chain, numbers.Vector(1.0), numbers.Vector(1.0), numbers.Errors(0.1, 0.3)};
}

Vector3d ErrorOf(const Case& c) {
  return VolumetricError<double>(c.chain, c.position, c.p_TQ, c.errors);
}

Chain Written(const std::string& workpiece, const std::string& tool) {
  return Chain::Parse("[w" + workpiece + "b" + tool + "t]");
}

RC_GTEST_PROP(VolumetricError, OfAPerfectMachineIsZeroEverywhere, ()) {
  Case c = AnyCase();
  c.errors = {};
  RC_ASSERT(ErrorOf(c).norm() < kRounding);
}

// The linearised model in two lines: every axis moves the tool point by its errors and its turn
// crossed with the nominal arm from its carriage to the tool point; the workpiece side counts
// negative.
RC_GTEST_PROP(VolumetricError, ToFirstOrderIsTheSumOfAbbeTerms, ()) {
  const Case c = AnyCase();
  const Vector3d& s = c.errors.squareness;
  const Vector3d lines[] = {
      Vector3d::Zero(), {-s.z(), 0.0, 0.0}, {s.y(), -s.x(), 0.0}};  // of unit travel
  Vector3d linear = Vector3d::Zero();
  const auto add = [&](int axis, double side, const Vector3d& arm) {
    const auto& e = c.errors.axes[axis];
    linear += side * (e.head<3>() + c.position[axis] * lines[axis] + e.tail<3>().cross(arm));
  };
  const auto travel = [&](char letter) -> Vector3d {
    return c.position[letter - 'X'] * Vector3d::Unit(letter - 'X');
  };
  // From the tool back to the bed, then on to the workpiece.
  Vector3d arm = c.p_TQ;
  const std::string tool(c.chain.tool_axes().rbegin(), c.chain.tool_axes().rend());
  const std::string work(c.chain.workpiece_axes().rbegin(), c.chain.workpiece_axes().rend());
  for (const char axis : tool) {
    add(axis - 'X', 1.0, arm);
    arm += travel(axis);
  }
  for (const char axis : work) {
    arm -= travel(axis);
    add(axis - 'X', -1.0, arm);
  }
  RC_ASSERT((FirstOrderError(c.chain, c.position, c.p_TQ, c.errors) - linear).norm() < kRounding);
}

// Errors stated at a point shifted by s: the translations change by what the turn does to s, the
// tool vector loses s.
RC_GTEST_PROP(VolumetricError, DoesNotDependOnWhereTheErrorsAreStated, ()) {
  const Case c = AnyCase();
  const Vector3d s = Numbers(*rc::gen::arbitrary<std::uint64_t>()).Vector(1.0);
  Case moved = c;
  moved.p_TQ -= s;
  for (auto& e : moved.errors.axes) {
    const Vector3d turn = e.tail<3>();
    e.head<3>() += geometry::ExpRotation<double>(turn) * s - s;
  }
  RC_ASSERT((ErrorOf(moved) - ErrorOf(c)).norm() < kRounding);
}

// Only the relative motion counts: an axis next to the bed that moves the workpiece one way may as
// well move the tool the other way.
RC_GTEST_PROP(VolumetricError, OfAWorkpieceAxisIsThatOfAToolAxisMovedBack, ()) {
  const Case c = AnyCase();
  RC_PRE(!c.chain.workpiece_axes().empty());
  const std::string& work = c.chain.workpiece_axes();
  const int axis = work.back() - 'X';
  Case turned = c;
  turned.chain = Written(work.substr(0, work.size() - 1), work.back() + c.chain.tool_axes());
  turned.position[axis] = -c.position[axis];
  const Vector3d l = LineOf<double>(axis, c.errors.squareness);
  const auto back = CarriagePose<double>(axis, 1.0, c.position[axis], c.errors).Inverse();
  turned.errors.axes[axis] << back.p + c.position[axis] * l, -c.errors.axes[axis].tail<3>();
  RC_ASSERT((ErrorOf(turned) - ErrorOf(c)).norm() < kRounding);
}

// The chain read from the tool's end: the workpiece seen from the tool is the inverse motion.
RC_GTEST_PROP(VolumetricError, OfTheReversedChainUndoesIt, ()) {
  const Case c = AnyCase();
  const std::string &work = c.chain.workpiece_axes(), &tool = c.chain.tool_axes();
  const Chain reversed = Written({tool.rbegin(), tool.rend()}, {work.rbegin(), work.rend()});
  const Vector3d p_WQ = ToolInWork<double>(c.chain, c.position, c.p_TQ, c.errors);
  RC_ASSERT((ToolInWork<double>(reversed, c.position, p_WQ, c.errors) - c.p_TQ).norm() < kRounding);
}

// A machine whose control counts the other way is the same machine: at the same places of its
// carriages the same tool meets the same place of the workpiece.
RC_GTEST_PROP(VolumetricError, IsTheSameWhicheverWayTheControlCounts, ()) {
  const Case c = AnyCase();
  Case counted = c;
  std::array<Positive, 3> positive{};
  for (std::size_t axis = 0; axis < positive.size(); ++axis) {
    positive[axis] = *rc::gen::arbitrary<bool>() ? Positive::kTool : Positive::kCarriage;
    if (positive[axis] != Positive::kTool || !c.chain.CarriesTarget("XYZ"[axis])) continue;
    const auto at = static_cast<Eigen::Index>(axis);
    counted.position[at] = -c.position[at];
    counted.errors.axes[axis][at] = -c.errors.axes[axis][at];
  }
  counted.chain.SetPositive(positive);
  RC_ASSERT((ErrorOf(counted) - ErrorOf(c)).norm() < kRounding);
  RC_ASSERT((NominalToolInWork<double>(counted.chain, counted.position, c.p_TQ) -
             NominalToolInWork<double>(c.chain, c.position, c.p_TQ))
                .norm() < kRounding);
}

// Counted as the tool goes, a positioning error is that of ISO 230-2 whoever carries what: + is
// further along the count, and the tool stands further towards + in the workpiece.
RC_GTEST_PROP(VolumetricError, CountedAsTheToolGoesIsAlongTheCount, ()) {
  Case c = AnyCase();
  c.chain.SetPositive({Positive::kTool, Positive::kTool, Positive::kTool});
  const int axis = *rc::gen::inRange(0, kAxes);
  const double e = c.errors.axes[axis][axis];
  c.errors = {};
  c.errors.axes[axis][axis] = e;
  RC_ASSERT((ErrorOf(c) - e * Vector3d::Unit(axis)).norm() < kRounding);
  RC_ASSERT(c.chain.ToolSenses() == Vector3d::Ones());
}

// Without turns the error is the sum of the displacements, in whatever order the axes stand.
RC_GTEST_PROP(VolumetricError, WithoutTurnsKnowsNoOrderOfTheAxesOfOneSide, ()) {
  Case c = AnyCase();
  for (auto& e : c.errors.axes) e.tail<3>().setZero();
  Case shuffled = c;
  std::string work = c.chain.workpiece_axes(), tool = c.chain.tool_axes();
  std::sort(work.begin(), work.end());
  std::sort(tool.begin(), tool.end());
  shuffled.chain = Written(work, tool);
  RC_ASSERT((ErrorOf(shuffled) - ErrorOf(c)).norm() < kRounding);
}

// The Abbe arm: an axis that turns by R carries the other axis along, or is carried by it. The two
// orders differ by what R does to the other's travel.
RC_GTEST_PROP(VolumetricError, ChangesWithTheOrderByTheArmAlone, ()) {
  Case c = AnyCase();
  c.chain = Chain::Parse("[w b X Y Z t]");
  for (const int axis : {1, 2}) c.errors.axes[axis].tail<3>().setZero();
  Case swapped = c;
  swapped.chain = Chain::Parse("[w b Y X Z t]");
  const Vector3d turn = c.errors.axes[0].tail<3>();
  const Vector3d travel_of_y =
      c.errors.axes[1].head<3>() + c.position.y() * LineOf<double>(1, c.errors.squareness);
  const Vector3d arm = geometry::ExpRotation<double>(turn) * travel_of_y - travel_of_y;
  RC_ASSERT((ErrorOf(c) - ErrorOf(swapped) - arm).norm() < kRounding);
}

// A machine whose only error is a positioning error errs by it along the axis, whatever the tool
// and the other positions; against it where the axis carries the workpiece.
RC_GTEST_PROP(VolumetricError, OfOnePositioningErrorIsThatError, ()) {
  Case c = AnyCase();
  const int axis = *rc::gen::inRange(0, kAxes);
  const double e = c.errors.axes[axis][axis];
  c.errors = {};
  c.errors.axes[axis][axis] = e;
  const double side = c.chain.CarriesTarget("XYZ"[axis]) ? -1.0 : 1.0;
  RC_ASSERT((ErrorOf(c) - side * e * Vector3d::Unit(axis)).norm() < kRounding);
}

}  // namespace volumetric_property_test
}  // namespace abbe::machine
