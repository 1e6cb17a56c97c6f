#include "map/map_grid.h"

#include "failure/failure.h"
#include "map_cases.h"

namespace abbe::map {
namespace map_grid_test {

using Eigen::Vector3d;

// m: of the error as a difference of positions below 0.1 m, each rounded some times.
constexpr double kRounding = 16 * 2.2e-16 * 0.1;

// Interpolating a sum of products of linear functions is exact: a machine with constant pitches and
// squareness has such an error to first order, and 1e-4^2 beyond.
TEST(MapGrid, IsExactAtItsPointsAndForALinearMap) {
  const ErrorMap map = RandomMap(1);
  const Vector3d tool(0.01, 0.02, -0.05);
  const MapGrid grid = SampleGrid(map, tool, {5, 4, 3});
  ASSERT_EQ(grid.size(), 60);
  for (Eigen::Index i = 0; i < grid.size(); ++i) {
    EXPECT_LT((grid.Error(grid.Position(i)) - map.Error(grid.Position(i), tool)).norm(), kRounding);
  }
  EXPECT_LT((grid.Position(1) - Vector3d(0.015, 0, 0)).norm(), 1e-17);
  machine::VolumetricModel skew(map.model().chain(), map.model().travels());
  skew.SetSquareness({30e-6, -20e-6, 10e-6});
  const ErrorMap linear(map.origin(), skew, {});
  const MapGrid coarse = SampleGrid(linear, tool, {2, 2, 2});
  EXPECT_LT(InterpolationError(linear, tool, coarse).largest, 1e-15);
  EXPECT_GT(InterpolationError(linear, tool, coarse).error, 1e-6);
}

TEST(MapGrid, ItsStatedErrorFallsWithTheSquareOfTheSpacingAndBoundsAllPoints) {
  const ErrorMap full = RandomMap(4);
  const ErrorMap map(full.origin(), full.model(), {});
  const Vector3d tool(0.0, 0.0, -0.1);
  const auto stated = [&](Eigen::Index n) {
    return InterpolationError(map, tool, SampleGrid(map, tool, {n, n, n})).largest;
  };
  const double ratio = stated(13) / stated(25);
  EXPECT_GT(ratio, 3.0);
  EXPECT_LT(ratio, 5.0);
  const MapGrid grid = SampleGrid(map, tool, {13, 13, 13});
  const Discrepancy between = Compare(
      map, tool, [&](const Vector3d& p) { return grid.Error(p); }, 2000);
  EXPECT_LT(between.largest, 1.1 * stated(13));
  EXPECT_GT(between.largest, 0.3 * stated(13));
  EXPECT_LE(between.rms, between.largest);
}

TEST(MapGrid, CarriesTheUncertaintyOfTheMap) {
  const ErrorMap map = RandomMap(1);
  const Vector3d tool = map.origin().tool;
  const MapGrid grid = SampleGrid(map, tool, {3, 3, 3});
  const Vector3d u = map.StandardUncertainty(grid.Position(14), tool);
  EXPECT_LT((grid.u95().col(14) - 2.0 * u).norm(), 1e-6 * u.norm());
  const ErrorMap bare(map.origin(), map.model(), {});
  EXPECT_EQ(SampleGrid(bare, tool, {2, 2, 2}).u95().size(), 0);
}

TEST(MapGrid, RefusesWhatLiesOutside) {
  const ErrorMap map = RandomMap(1);
  const MapGrid grid = SampleGrid(map, Vector3d::Zero(), {3, 3, 3});
  ExpectHas(MessageOf<InputError>([&] { grid.Error({0.01, 0.0601, 0.01}); }), "Y = 60.1 mm");
  EXPECT_THROW(SampleGrid(map, Vector3d::Zero(), {3, 1, 3}), InputError);
}

}  // namespace map_grid_test
}  // namespace abbe::map
