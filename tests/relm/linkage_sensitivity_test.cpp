#include "relm/linkage_sensitivity.h"

#include <gtest/gtest.h>

#include <cmath>

#include "failure/failure.h"
#include "linkage_by_matrices.h"
#include "relm/error_models.h"
#include "relm/nominal_angles.h"

namespace abbe::relm {
namespace linkage_sensitivity_test {

using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr SensitivityOptions kQuick{.draws = 512, .seed = 3};
const SensitivityVolume kCorners{.points = 2};

TEST(PosesInVolume, PutTheBallOnTheGridOfTheVolume) {
  const LinkageSettings settings = TestLinkage();
  const SensitivityVolume volume{{0.02, 0.04, 0.06}, {0.005, 0, -0.01}, 3};
  const LinkageReadings poses = PosesInVolume(settings, volume, 2.5);
  ASSERT_EQ(poses.poses(), 28);
  EXPECT_EQ(poses.warmth, VectorXd::Constant(28, 2.5));
  std::vector<Vector3d> expected{volume.centre};
  for (const double z : {-0.04, -0.01, 0.02}) {
    for (const double y : {-0.02, 0.0, 0.02}) {
      for (const double x : {-0.005, 0.005, 0.015}) expected.emplace_back(x, y, z);
    }
  }
  for (Eigen::Index i = 0; i < 28; ++i) {
    const Vector3d p_BT = settings.pivots->Tip(poses.angles.col(i));
    EXPECT_LT((settings.X_MB * p_BT - expected[static_cast<std::size_t>(i)]).norm(), 1e-14);
    EXPECT_EQ(settings.pivots->BranchOf(poses.angles.col(i)).elbow, Elbow::kUp);
  }
}

TEST(PosesInVolume, RefuseAVolumeWithoutPosesAndOneOutOfReach) {
  const LinkageSettings settings = TestLinkage();
  EXPECT_THROW(PosesInVolume(settings, {.points = 1}), InputError);
  EXPECT_THROW(PosesInVolume(settings, {.size = {0.02, 0, 0.02}}), InputError);
  EXPECT_THROW(PosesInVolume(settings, {.size = {0.5, 0.5, 0.5}}), NumericalError);
}

// The same chain without a closed form is searched for, and says the same on its branch.
TEST(NominalAngles, OfAnyChainPutTheBallThere) {
  LinkageSettings settings = TestLinkage();
  const Vector3d p(0.15, 0.02, 0.04);
  const VectorXd closed = NominalAngles(settings, p);
  settings.pivots.reset();
  EXPECT_LT((settings.chain.Tip(NominalAngles(settings, p)) - p).norm(), 1e-12);
  EXPECT_LT((NominalAngles(settings, p, closed + VectorXd::Constant(3, 0.1)) - closed).norm(),
            1e-10);
  EXPECT_THROW(NominalAngles(settings, Vector3d(1, 0, 0)), NumericalError);
}

// For errors as small as these the tip error is linear in them: what a parameter does alone is its
// column of the Jacobian times its tolerance, and its share of the mean square is that, squared,
// over the sum. The second order, 1e-3 of the first, shows in the fourth digit.
TEST(LinkageSensitivity, IsTheLinearOneForSmallErrors) {
  const LinkageSettings settings = TestLinkage();
  for (const ErrorModel which : {ErrorModel::kPublishedWithBearing, ErrorModel::kComplete}) {
    const LinkageModel model = MakeLinkageModel(settings, which);
    const LinkageReadings poses = PosesInVolume(settings, kCorners, 5.0);
    const LinkageSensitivity result = AnalyseSensitivity(model, poses, kQuick);
    Eigen::Matrix3Xd tips;
    RowMatrix J;
    model.Tips(poses, model.Values(), tips, &J);
    ASSERT_EQ(result.parameters.size(), static_cast<std::size_t>(model.parameters()));
    std::vector<double> squares;
    double sum = 0;
    for (std::size_t i = 0; i < result.parameters.size(); ++i) {
      const double sd = result.parameters[i].tolerance;
      const auto column = J.col(static_cast<Eigen::Index>(i));
      squares.push_back(sd * sd * column.squaredNorm() / static_cast<double>(poses.poses()));
      sum += squares.back();
      EXPECT_NEAR(result.parameters[i].alone, std::sqrt(squares[i]), 2e-3 * std::sqrt(squares[i]));
      EXPECT_GE(result.parameters[i].worst, result.parameters[i].alone);
    }
    // The variance of 512 pairs of draws is good to sqrt(2 / 512), the root to half of that.
    EXPECT_NEAR(result.together, std::sqrt(sum), 5 * 0.032 * std::sqrt(sum));
    for (std::size_t i = 0; i < squares.size(); ++i) {
      const estimation::SobolIndex& share = result.parameters[i].share;
      EXPECT_NEAR(share.first, squares[i] / sum, 5 * share.first_uncertainty + 1e-4);
      EXPECT_NEAR(share.total, squares[i] / sum, 5 * share.total_uncertainty + 1e-4);
    }
  }
}

// A displacement does not see what moves the whole linkage: the offset of pivot 1.
TEST(LinkageSensitivity, OfDisplacementsDropsWhatAllPosesShare) {
  const LinkageSettings settings = TestLinkage();
  const LinkageModel model = CompleteErrorModel(settings);
  const LinkageReadings poses = PosesInVolume(settings, kCorners);
  SensitivityOptions options = kQuick;
  options.displacement = true;
  const LinkageSensitivity seen = AnalyseSensitivity(model, poses, options);
  const LinkageSensitivity all = AnalyseSensitivity(model, poses, kQuick);
  EXPECT_LT(seen.together, all.together);
  for (std::size_t i = 0; i < seen.parameters.size(); ++i) {
    if (!seen.parameters[i].name.starts_with("shift.pivot_1")) continue;
    EXPECT_LT(seen.parameters[i].alone, 1e-15);
    EXPECT_NEAR(all.parameters[i].alone, all.parameters[i].tolerance, 1e-15);
  }
}

TEST(LinkageSensitivity, LeavesOutWhatIsHeldAndRefusesWhatHasNoTolerance) {
  LinkageSettings settings = TestLinkage();
  settings.tolerance.link = 0;
  const LinkageModel held = PivotErrorModel(settings);
  EXPECT_EQ(AnalyseSensitivity(held, PosesInVolume(settings, kCorners), kQuick).parameters.size(),
            9U);
  settings.tolerance.link = estimation::kNoPrior;
  const LinkageModel open = PivotErrorModel(settings);
  EXPECT_THROW(AnalyseSensitivity(open, PosesInVolume(settings, kCorners), kQuick), InputError);
}

TEST(LinkageSensitivity, IsTheSameForAnyNumberOfThreads) {
  const LinkageSettings settings = TestLinkage();
  const LinkageModel model = PublishedErrorModel(settings, true);
  const LinkageReadings poses = PosesInVolume(settings, kCorners);
  SensitivityOptions options{.draws = 300, .threads = 1};
  const LinkageSensitivity one = AnalyseSensitivity(model, poses, options);
  options.threads = 2;
  const LinkageSensitivity two = AnalyseSensitivity(model, poses, options);
  EXPECT_EQ(one.together, two.together);
  for (std::size_t i = 0; i < one.parameters.size(); ++i) {
    EXPECT_EQ(one.parameters[i].share.first, two.parameters[i].share.first);
    EXPECT_EQ(one.parameters[i].share.total, two.parameters[i].share.total);
  }
}

}  // namespace linkage_sensitivity_test
}  // namespace abbe::relm
