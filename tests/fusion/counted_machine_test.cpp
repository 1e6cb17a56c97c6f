// Machines of every shape on the virtual rig, counted as their carriages go and as ISO 841 has it:
// the same machine gives the same errors and the same map at the same places.
#include "tests/counted_machine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fusion/fuse.h"
#include "simulation/points/reference_simulation.h"
#include "tests/fusion/rig_campaign.h"

namespace abbe::fusion {
namespace counted_machine_test {

using Eigen::Vector3d;

constexpr double kTravelOfDemo = 0.060;  // m

class CountedMachine {
 public:
  CountedMachine(const std::string& chain, bool as_tool, std::uint64_t seed)
      : document_(tests::MachineOf(chain, as_tool)), campaign_(document_, seed) {}

  const Campaign& campaign() const { return campaign_; }
  const machine::Chain& chain() const { return campaign_.machine.chain; }

  // What the control shows where the carriages stand.
  Vector3d NumbersOf(const Vector3d& carriages) const {
    return {chain().CarriageSense('X') * carriages.x(), chain().CarriageSense('Y') * carriages.y(),
            chain().CarriageSense('Z') * carriages.z()};
  }

  map::ErrorMap Map() const {
    std::vector<simulation::SimulatedRun> runs{campaign_.Sweep('X'), campaign_.Sweep('Y'),
                                               campaign_.Sweep('Z')};
    const Vector3d middle = NumbersOf(Vector3d::Constant(0.5 * kTravelOfDemo));
    const auto course = rig::DwellCourse(
        rig::GridPlaces(middle, Vector3d::Constant(0.058), {6, 6, 6}), 0.1, 0.1, 1);
    auto grid = campaign_.rig.Record(course, {.kind = "reference", .rate = 100.0});
    grid.name = "grid";
    runs.push_back(
        simulation::SimulateReference(campaign_.model, campaign_.reference, 0.3e-6, grid));
    return Fuse(campaign_.machine, runs, {.choose_smoothness = false}).map;
  }

 private:
  settings::Document document_;
  Campaign campaign_;
};

std::vector<Vector3d> Places() {
  std::vector<Vector3d> places;
  for (double x = 0.002; x < kTravelOfDemo; x += 0.014) {
    for (double y = 0.002; y < kTravelOfDemo; y += 0.014) {
      for (double z = 0.002; z < kTravelOfDemo; z += 0.014) places.emplace_back(x, y, z);
    }
  }
  return places;
}

// rms of what no rigid motion of the workpiece explains in errors at places of the workpiece: which
// end of a travel counts as zero turns and shifts the whole.
double BesideRigidMotion(const std::vector<Vector3d>& at, const std::vector<Vector3d>& errors) {
  const auto n = static_cast<Eigen::Index>(at.size());
  Eigen::MatrixXd A(3 * n, 6);
  Eigen::VectorXd b(3 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vector3d& p = at[static_cast<std::size_t>(i)];
    A.middleRows<3>(3 * i).leftCols<3>().setIdentity();
    A.middleRows<3>(3 * i).rightCols<3>() << 0, p.z(), -p.y(), -p.z(), 0, p.x(), p.y(), -p.x(), 0;
    b.segment<3>(3 * i) = errors[static_cast<std::size_t>(i)];
  }
  const Eigen::VectorXd left = b - A * A.colPivHouseholderQr().solve(b).eval();
  return std::sqrt(left.squaredNorm() / static_cast<double>(n));
}

class HoweverCounted : public testing::TestWithParam<const char*> {};

TEST_P(HoweverCounted, TheSameMachineHasTheSameMap) {
  const CountedMachine by_carriage(GetParam(), false, 5), as_tool(GetParam(), true, 5);
  const map::ErrorMap one = by_carriage.Map(), other = as_tool.Map();
  std::vector<Vector3d> at, truth, off_one, off_other, apart;
  for (const Vector3d& carriages : Places()) {
    const Vector3d numbers = as_tool.NumbersOf(carriages), none = Vector3d::Zero();
    at.push_back(relm::NominalTip(by_carriage.chain(), carriages));
    EXPECT_EQ(at.back(), relm::NominalTip(as_tool.chain(), numbers));
    truth.push_back(by_carriage.campaign().TrueError(carriages));
    EXPECT_LT((truth.back() - as_tool.campaign().TrueError(numbers)).norm(), 1e-15);
    const Vector3d first = one.Error(carriages, none), second = other.Error(numbers, none);
    off_one.push_back(first - truth.back());
    off_other.push_back(second - truth.back());
    apart.push_back(second - first);
  }
  // The two campaigns differ in their noise only, 0.3 um of the grid encoder in 216 places.
  EXPECT_LT(BesideRigidMotion(at, off_one), 0.3e-6);
  EXPECT_LT(BesideRigidMotion(at, off_other), 0.3e-6);
  EXPECT_LT(BesideRigidMotion(at, apart), 0.4e-6);
  EXPECT_GT(BesideRigidMotion(at, truth), 1.5e-6);  // there was something to find
}

INSTANTIATE_TEST_SUITE_P(Chains, HoweverCounted,
                         testing::Values("[w X Y b Z t]", "[w Y X b Z t]", "[w Y b X Z t]",
                                         "[w X b Z Y t]", "[w X Y Z b t]"));

}  // namespace counted_machine_test
}  // namespace abbe::fusion
