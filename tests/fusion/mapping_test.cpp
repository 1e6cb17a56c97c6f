// Mapping: the grid of cells, the blend between them, and what local parameters are worth.
#include "fusion/mapping.h"

#include <gtest/gtest.h>

#include <cmath>

#include "failure/failure.h"
#include "fusion/calibrate.h"
#include "fusion/model_comparison.h"
#include "linkage_world.h"

namespace abbe::fusion {
namespace mapping_test {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using relm::ErrorModel;

const Vector3d kCube(0.025, 0.025, 0.050);

simulation::LinkageSimulation Published() {
  const auto settings = WorldSettings();
  return {WorldChain(), settings, relm::MakeLinkageModel(settings, ErrorModel::kPublished)};
}

// Boelens (2006): 7 x 7 x 12 poses, 12 neighbours each; the cuboctahedron over steps hx, hy, hz has
// (20/3) hx hy hz, for this grid the document's 530 mm^3.
TEST(Mapping, CellsOfThePublishedGrid) {
  const auto settings = WorldSettings();
  const auto run = WorldRun(LinkageWorld{}, settings, GridPositions(kCube, {7, 7, 12}), 0, 1);
  const auto simulation = Published();
  const MappedParameters cells = MapParameters(simulation, run, simulation.Values());
  EXPECT_EQ(cells.values.size(), 5U * 5U * 10U);
  const double hx = cells.centres[0][1] - cells.centres[0][0];
  const double hz = cells.centres[2][1] - cells.centres[2][0];
  EXPECT_NEAR(20.0 / 3.0 * hx * hx * hz * 1e9, 530.0, 5.0);
  // A linkage without errors: every cell finds the nominal parameters.
  for (const VectorXd& values : cells.values) {
    EXPECT_LT((values - simulation.model().Values()).cwiseAbs().maxCoeff(), 1e-9);
  }
}

// Over the border of two cells and out of the grid the corrected path takes no jump: steps a
// thousand times smaller move the ball a thousand times less.
TEST(Mapping, CorrectedPathIsContinuous) {
  const auto settings = WorldSettings();
  const auto simulation = Published();
  const auto run =
      WorldRun(LinkageWorld::Draw(2, true), settings, GridPositions(kCube, {5, 5, 5}), 1, 2);
  const auto report = Calibrate(WorldChain(), settings, {run},
                                {.model = ErrorModel::kPublished, .folds = 1, .mapped = true});
  const CalibratedLinkage linkage(settings, report.calibration);
  const auto correction = [&](double x) {  // of the mapping, along a line through the whole grid
    Matrix3Xd at(3, 1);
    at << x, 0.031, 0.033;
    auto one = WorldRun(LinkageWorld{}, settings, at, 0, 1);
    CalibrationReport global = report;
    global.calibration.mapped.reset();
    return Vector3d(linkage.Tips(one.readings) -
                    CalibratedLinkage(settings, global.calibration).Tips(one.readings));
  };
  double largest = 0.0, jump = 0.0;
  for (double x = 0.012; x < 0.048; x += 0.25e-3) {
    largest = std::max(largest, correction(x).norm());
    jump = std::max(jump, (correction(x + 1e-9) - correction(x)).norm());
  }
  EXPECT_GT(largest, 0.1e-6);                      // the cells do differ
  EXPECT_LT(jump, 1e-9 * 100.0 * largest / 1e-3);  // no steeper than its size over 10 um
}

// rms of the ball positions at 200 other poses over most of the travel.
double OtherRms(const LinkageWorld& world, double ripple, ErrorModel model, bool mapped) {
  const auto settings = WorldSettings();
  const Vector3d travel(0.060, 0.060, 0.060);
  auto grid = WorldRun(world, settings, GridPositions(travel, {7, 7, 7}), 1, 4);
  auto other = WorldRun(world, settings, RandomPositions(0.8 * travel, 200, 5), 0, 5);
  for (auto* run : {&grid, &other}) {  // a fault of the first encoder that no model knows
    auto q = run->readings.angles.row(0).array();
    q += ripple * (20.0 * q).sin();
  }
  const auto report =
      Calibrate(WorldChain(), settings, {grid}, {.model = model, .folds = 1, .mapped = mapped});
  Matrix3Xd truth = other.commanded;
  truth.topRows<2>() *= -1.0;
  const CalibratedLinkage linkage(settings, report.calibration);
  return DistancesOf(linkage.Tips(other.readings) - truth).rms;
}

TEST(Mapping, TakesUpWhatEveryModelLeavesOut) {
  const LinkageWorld world = LinkageWorld::Draw(4, true);
  const double global = OtherRms(world, 30e-6, ErrorModel::kPublished, false);
  const double mapped = OtherRms(world, 30e-6, ErrorModel::kPublished, true);
  EXPECT_GT(global, 2e-6);
  EXPECT_LT(mapped, 0.6 * global);
}

// A cell has 13 poses, the global set all of them: where a model leaves nothing out, cells only add
// noise.
TEST(Mapping, IsWorseThanAModelThatIsComplete) {
  const LinkageWorld world = LinkageWorld::Draw(4, true);
  EXPECT_LT(OtherRms(world, 0.0, ErrorModel::kComplete, false),
            0.7 * OtherRms(world, 0.0, ErrorModel::kPublished, true));
}

TEST(Mapping, RefusesPosesThatAreNoGrid) {
  const auto settings = WorldSettings();
  const auto simulation = Published();
  const auto run = WorldRun(LinkageWorld{}, settings, RandomPositions(kCube, 60, 3), 0, 1);
  EXPECT_THROW(MapParameters(simulation, run, simulation.Values()), InputError);
}

}  // namespace mapping_test
}  // namespace abbe::fusion
