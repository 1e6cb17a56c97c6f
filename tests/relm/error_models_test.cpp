#include "relm/error_models.h"

#include <ceres/jet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <functional>
#include <limits>
#include <set>
#include <string>

#include "failure/failure.h"
#include "linkage_by_matrices.h"
#include "random/counter_random.h"

namespace abbe::relm {
namespace error_models_test {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using ::testing::HasSubstr;

// A dozen products and sums of numbers up to the reach, on either side.
constexpr double kRounding = 32 * std::numeric_limits<double>::epsilon() * (kLink1 + kLink2);  // m

template <typename T>
using TipByMatrices = std::function<Eigen::Matrix<T, 3, 1>(const T*, const T&, const Named<T>&)>;

using Jet = ceres::Jet<double, 72>;

struct Case {
  const char* name;
  ErrorModel model;
  TipByMatrices<double> tip;
  TipByMatrices<Jet> jet;
};

const std::vector<Case>& Cases() {
  static const std::vector<Case> cases{
      {"pivots", ErrorModel::kPivots, PivotTipByMatrices<double>, PivotTipByMatrices<Jet>},
      {"published", ErrorModel::kPublished, PublishedTipByMatrices<double>,
       PublishedTipByMatrices<Jet>},
      {"published-with-bearing", ErrorModel::kPublishedWithBearing, PublishedTipByMatrices<double>,
       PublishedTipByMatrices<Jet>},
      {"complete", ErrorModel::kComplete, CompleteTipByMatrices<double>,
       CompleteTipByMatrices<Jet>}};
  return cases;
}

class EveryErrorModel : public ::testing::TestWithParam<Case> {
 protected:
  EveryErrorModel() : model_(MakeLinkageModel(TestLinkage(), GetParam().model)) {}

  Vector3d ByMatrices(const VectorXd& q, double warmth, const VectorXd& x) const {
    const auto names = model_.Names();
    Named<double> named;
    for (std::size_t i = 0; i < names.size(); ++i) named[names[i]] = x[static_cast<Index>(i)];
    return GetParam().tip(q.data(), warmth, named);
  }

  LinkageModel model_;
};
INSTANTIATE_TEST_SUITE_P(Relm, EveryErrorModel, ::testing::ValuesIn(Cases()),
                         [](const auto& param) {
                           std::string name = param.param.name;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

VectorXd AnyAngles(std::uint64_t draw) {
  VectorXd q(3);
  for (Index i = 0; i < 3; ++i) q[i] = random::CounterRandom(7, i).Uniform(draw, -3, 3);
  return q;
}

VectorXd AnyErrors(const LinkageModel& model, std::uint64_t draw, double times = 1) {
  VectorXd x = model.Values();
  Index i = 0;
  for (const auto& block : model.blocks()) {
    for (const auto& entry : block.entries) {
      x[i] += times * entry.prior_sd * random::CounterRandom(8, i).Normal(draw);
      ++i;
    }
  }
  return x;
}

TEST_P(EveryErrorModel, IsFoundByItsName) {
  std::string name = GetParam().name;
  EXPECT_EQ(ErrorModelName(GetParam().model), name);
  EXPECT_EQ(ErrorModelNamed(name), GetParam().model);
  std::replace(name.begin(), name.end(), '-', ' ');  // a file of an earlier version
  EXPECT_EQ(ErrorModelNamed(name), GetParam().model);
}

TEST(ErrorModelNamed, ListsTheNamesForAnotherText) {
  for (const char* text : {"", "best", "Complete", "published_with_bearing"}) {
    EXPECT_THAT([&] { ErrorModelNamed(text); },
                ::testing::ThrowsMessage<InputError>(
                    HasSubstr("pivots, published, published-with-bearing, complete")));
  }
}

TEST_P(EveryErrorModel, WithNominalParametersIsTheNominalLinkage) {
  EXPECT_EQ(model_.name(), GetParam().name);
  const PivotLinkage linkage(kLink1, kLink2);
  for (std::uint64_t draw = 0; draw < 100; ++draw) {
    const VectorXd q = AnyAngles(draw);
    EXPECT_LT((model_.Tip(q, 0, model_.Values()) - linkage.Tip(q)).norm(), kRounding);
  }
}

// One parameter after the other, far larger than it will ever be.
TEST_P(EveryErrorModel, MovesTheBallByEachParameterAsTheMatricesDo) {
  const double warmth = 7.0;
  for (Index i = 0; i < model_.parameters(); ++i) {
    double largest = 0;
    for (std::uint64_t draw = 0; draw < 20; ++draw) {
      const VectorXd q = AnyAngles(draw);
      VectorXd x = model_.Values();
      x[i] += 0.01;
      const Vector3d tip = model_.Tip(q, warmth, x);
      EXPECT_LT((tip - ByMatrices(q, warmth, x)).norm(), kRounding) << model_.Names()[i];
      largest = std::max(largest, (tip - model_.Tip(q, warmth, model_.Values())).norm());
    }
    EXPECT_GT(largest, 1e-4) << model_.Names()[i] << " does nothing";
  }
}

TEST_P(EveryErrorModel, MovesTheBallByAllParametersTogetherAsTheMatricesDo) {
  for (std::uint64_t draw = 0; draw < 200; ++draw) {
    const VectorXd q = AnyAngles(draw), x = AnyErrors(model_, draw, 10);
    EXPECT_LT((model_.Tip(q, -5.0, x) - ByMatrices(q, -5.0, x)).norm(), kRounding);
  }
}

TEST_P(EveryErrorModel, HasTheDerivativesOfTheMatrices) {
  const auto names = model_.Names();
  const Index parameters = model_.parameters();
  ASSERT_LE(parameters + 3, Jet::DIMENSION);
  for (std::uint64_t draw = 0; draw < 20; ++draw) {
    const VectorXd q = AnyAngles(draw), x = AnyErrors(model_, draw, 10);
    std::array<Jet, 3> jet_q;
    for (int k = 0; k < 3; ++k) jet_q[k] = Jet(q[k], static_cast<int>(parameters) + k);
    Named<Jet> named;
    for (Index i = 0; i < parameters; ++i) named[names[i]] = Jet(x[i], static_cast<int>(i));
    const Eigen::Matrix<Jet, 3, 1> expected = GetParam().jet(jet_q.data(), Jet(4.0), named);
    const TipDerivatives found = model_.Differentiate(q, 4.0, x);
    for (Index row = 0; row < 3; ++row) {
      // Per parameter: m/rad below the reach, m/m 1, m per 1/K below warmth x reach.
      EXPECT_NEAR(found.tip[row], expected[row].a, kRounding);
      EXPECT_LT((found.J_tip_x.row(row).transpose() - expected[row].v.head(parameters))
                    .cwiseAbs()
                    .maxCoeff(),
                10 * kRounding);
      EXPECT_LT((found.J_tip_q.row(row).transpose() - expected[row].v.segment(parameters, 3))
                    .cwiseAbs()
                    .maxCoeff(),
                10 * kRounding);
    }
  }
}

TEST_P(EveryErrorModel, SaysTheSameForOnePoseForManyAndForJets) {
  LinkageReadings readings{Eigen::MatrixXd(3, 5), VectorXd::LinSpaced(5, -2, 2)};
  for (Index k = 0; k < 5; ++k) readings.angles.col(k) = AnyAngles(k);
  const VectorXd x = AnyErrors(model_, 1);
  Matrix3Xd tips;
  RowMatrix jacobian;
  model_.Tips(readings, x, tips, &jacobian);
  for (Index k = 0; k < 5; ++k) {
    const VectorXd q = readings.angles.col(k);
    const TipDerivatives one = model_.Differentiate(q, readings.warmth[k], x);
    EXPECT_EQ(tips.col(k), one.tip);
    EXPECT_EQ(RowMatrix(jacobian.middleRows(3 * k, 3)), one.J_tip_x);
    EXPECT_LT((model_.Tip(q, readings.warmth[k], x) - one.tip).norm(), kRounding);
    std::vector<Jet> jet_q(q.begin(), q.end()), jet_x(x.begin(), x.end());
    const auto jet = model_.Tip<Jet>(jet_q.data(), Jet(readings.warmth[k]), jet_x.data());
    EXPECT_LT((Vector3d(jet[0].a, jet[1].a, jet[2].a) - one.tip).norm(), kRounding);
  }
}

TEST_P(EveryErrorModel, RefusesTheWrongNumberOfAnything) {
  const VectorXd x = model_.Values(), q = VectorXd::Zero(3);
  EXPECT_THROW(model_.Tip(VectorXd::Zero(2), 0, x), InputError);
  EXPECT_THROW(model_.Tip(q, 0, VectorXd::Zero(x.size() + 1)), InputError);
  EXPECT_THROW(model_.Differentiate(VectorXd::Zero(4), 0, x), InputError);
  Matrix3Xd tips;
  EXPECT_THROW(model_.Tips({Eigen::MatrixXd::Zero(3, 2), VectorXd::Zero(3)}, x, tips), InputError);
}

// At zero angles the ball stands at (L1, 0, L2) and pivot 3 at (L1, 0, 0). A turn about a line
// moves it by direction x arm; by hand:
TEST(PivotErrorModel, MovesTheBallAtZeroAnglesAsDrawnByHand) {
  const std::vector<std::pair<const char*, Vector3d>> by_hand = {
      {"link.link_1", {1, 0, 0}},
      {"link.link_2", {0, 0, 1}},
      {"tilt.pivot_1_x", {0, -kLink2, 0}},       // x x (L1, 0, L2)
      {"tilt.pivot_1_y", {kLink2, 0, -kLink1}},  // y x (L1, 0, L2)
      {"twist.pivot_2", {0, -kLink2, 0}},        // the same line as the tilt, while q1 = 0
      {"twist.link_1", {0, -kLink2, 0}},         // x x (0, 0, L2)
      {"divergence.pivot_2_x", {1, 0, 0}},
      {"divergence.pivot_2_y", {0, 1, 0}},
      {"encoder_offset.pivot_1", {0, kLink1, 0}},  // z x (L1, 0, L2)
      {"encoder_offset.pivot_2", {kLink2, 0, -kLink1}},
      {"encoder_offset.pivot_3", {kLink2, 0, 0}},  // y x (0, 0, L2)
  };
  const LinkageModel model = PivotErrorModel(TestLinkage());
  const RowMatrix J = model.Differentiate(VectorXd::Zero(3), 0, model.Values()).J_tip_x;
  ASSERT_EQ(model.parameters(), static_cast<Index>(by_hand.size()));
  for (std::size_t i = 0; i < by_hand.size(); ++i) {
    EXPECT_EQ(model.Names()[i], by_hand[i].first);
    EXPECT_LT((J.col(static_cast<Index>(i)) - by_hand[i].second).norm(), 1e-15) << by_hand[i].first;
  }
}

TEST(PublishedErrorModel, HasTwelveAndTwentyFourParameters) {
  const LinkageSettings settings = TestLinkage();
  const LinkageModel geometric = PublishedErrorModel(settings, false);
  const LinkageModel both = PublishedErrorModel(settings, true);
  EXPECT_EQ(geometric.parameters(), 12);
  EXPECT_EQ(both.parameters(), 24);
  ASSERT_EQ(both.blocks().size(), 4U);
  const std::vector<Index> sizes{5, 2, 5, 12};  // links, head axis, radial angles, bearings
  for (std::size_t i = 0; i < sizes.size(); ++i) EXPECT_EQ(both.blocks()[i].size(), sizes[i]);
}

SerialChain AnyChain(int joints, std::uint64_t draw) {
  std::vector<JointAxis> axes(joints);
  const auto vector = [&](std::uint64_t stream) {
    const random::CounterRandom r(draw, stream);
    return Vector3d(r.Uniform(0, -1, 1), r.Uniform(1, -1, 1), r.Uniform(2, -1, 1));
  };
  for (int i = 0; i < joints; ++i) axes[i] = {vector(2 * i), vector(2 * i + 1)};
  return SerialChain(axes, vector(99));
}

Index Geometric(const LinkageModel& model) {
  Index count = 0;
  for (const auto& block : model.blocks()) {
    if (block.name == "tilt" || block.name == "shift" || block.name == "ball")
      count += block.size();
  }
  return count;
}

// Columns are scaled to their priors; rank by the gap that a random chain leaves.
Index RankOf(const Eigen::MatrixXd& J) {
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(J);
  qr.setThreshold(1e-10);
  return qr.rank();
}

RowMatrix JacobianOver(const LinkageModel& model, int poses, std::uint64_t seed) {
  LinkageReadings readings{Eigen::MatrixXd(model.joints(), poses), {}};
  for (Index i = 0; i < model.joints(); ++i) {
    for (int k = 0; k < poses; ++k) {
      readings.angles(i, k) = random::CounterRandom(seed, i).Uniform(k, -3, 3);
    }
  }
  Matrix3Xd tips;
  RowMatrix jacobian;
  model.Tips(readings, model.Values(), tips, &jacobian);
  return jacobian;
}

// The complete model of n revolute joints with a ball has 4 n + 3 parameters, all of them seen by
// some set of poses (Everett, Suryohadiprojo, "A study of kinematic models for forward calibration
// of manipulators", 1988: 4 R + 2 P + 6 for a pose, less the 3 of an orientation that is not
// measured), and an encoder offset is a combination of them.
TEST(CompleteErrorModel, HasFourParametersAJointAndThreeAndNoneTooMany) {
  for (int joints = 1; joints <= 6; ++joints) {
    LinkageSettings settings = TestLinkage();
    settings.chain = AnyChain(joints, 3);
    const LinkageModel model = CompleteErrorModel(settings);
    EXPECT_EQ(Geometric(model), 4 * joints + 3);
    const Eigen::MatrixXd J = JacobianOver(model, 80, 5);
    const Index geometric = Geometric(model);
    EXPECT_EQ(RankOf(J.leftCols(geometric)), geometric) << joints;
    EXPECT_EQ(model.blocks()[3].name, "encoder_offset");
    EXPECT_EQ(RankOf(J.leftCols(geometric + joints)), RankOf(J.leftCols(geometric))) << joints;
  }
}

TEST(CompleteErrorModel, HasTheTermsOfEncodersBearingsGravityAndWarmth) {
  const LinkageModel model = CompleteErrorModel(TestLinkage());
  std::map<std::string, Index> sizes;
  for (const auto& block : model.blocks()) sizes[block.name] = block.size();
  // Pivot 1 stands upright and is blind to gravity; pivots 1 and 2 meet, so no link is between.
  const std::map<std::string, Index> expected{
      {"tilt", 6},           {"shift", 6},        {"ball", 3},
      {"encoder_offset", 3}, {"eccentricity", 6}, {"graduation", 12},
      {"bearing", 24},       {"compliance", 2},   {"expansion", 2}};
  EXPECT_EQ(sizes, expected);
}

// How near the tips of `complete` come to `target` with the parameters `free`: Gauss-Newton.
double LeastDistance(const LinkageModel& complete, const std::vector<Index>& free,
                     const LinkageReadings& readings, const Matrix3Xd& target) {
  VectorXd x = complete.Values();
  Matrix3Xd tips;
  RowMatrix J;
  for (int step = 0; step < 8; ++step) {
    complete.Tips(readings, x, tips, &J);
    const Eigen::MatrixXd slope = J(Eigen::all, free);
    const Matrix3Xd miss = target - tips;
    const VectorXd change =
        slope.completeOrthogonalDecomposition().solve(VectorXd(miss.reshaped()));
    x(free) += change;
  }
  complete.Tips(readings, x, tips);
  return (target - tips).colwise().norm().maxCoeff();
}

std::vector<Index> InBlocks(const LinkageModel& model, const std::set<std::string>& names) {
  std::vector<Index> found;
  Index i = 0;
  for (const auto& block : model.blocks()) {
    for (Index k = 0; k < block.size(); ++k, ++i) {
      if (names.contains(block.name)) found.push_back(i);
    }
  }
  return found;
}

// Any tips of the two published geometries, with errors ten times the tolerance, are tips of the
// complete model: it is fitted to 100 poses and meets all of them.
TEST(CompleteErrorModel, ContainsThePublishedGeometriesExactly) {
  const LinkageSettings settings = TestLinkage();
  const LinkageModel complete = CompleteErrorModel(settings);
  LinkageReadings readings{Eigen::MatrixXd(3, 100), {}};
  for (Index k = 0; k < 100; ++k) readings.angles.col(k) = AnyAngles(k);
  const auto geometry = InBlocks(complete, {"tilt", "shift", "ball"});
  for (const ErrorModel other : {ErrorModel::kPivots, ErrorModel::kPublished}) {
    const LinkageModel published = MakeLinkageModel(settings, other);
    for (std::uint64_t draw = 0; draw < 5; ++draw) {
      Matrix3Xd target, nominal;
      published.Tips(readings, AnyErrors(published, draw, 10), target);
      published.Tips(readings, published.Values(), nominal);
      EXPECT_GT((target - nominal).colwise().norm().maxCoeff(), 1e-4);
      EXPECT_LT(LeastDistance(complete, geometry, readings, target), kRounding) << published.name();
    }
  }
}

// A run-out along the turning link is, for the part that carries the pivot, one in two directions
// with the harmonics beside its own: with one harmonic more the complete model has it.
TEST(CompleteErrorModel, ContainsThePublishedBearingsExactly) {
  LinkageSettings settings = TestLinkage();
  const LinkageModel published = PublishedErrorModel(settings, true);
  const LinkageModel narrow = CompleteErrorModel(settings);
  settings.bearing_harmonics.push_back(3);
  const LinkageModel complete = CompleteErrorModel(settings);
  const std::set<std::string> free{"tilt", "shift", "ball", "bearing"};
  LinkageReadings readings{Eigen::MatrixXd(3, 100), {}};
  for (Index k = 0; k < 100; ++k) readings.angles.col(k) = AnyAngles(k);
  for (std::uint64_t draw = 0; draw < 5; ++draw) {
    Matrix3Xd target;
    published.Tips(readings, AnyErrors(published, draw, 10), target);
    EXPECT_LT(LeastDistance(complete, InBlocks(complete, free), readings, target), kRounding);
    EXPECT_GT(LeastDistance(narrow, InBlocks(narrow, free), readings, target), 1e-7);
  }
}

// The other way round it is not true: no published parameter does what a lean of pivot 3 along
// link 1, an eccentric encoder or gravity does.
TEST(PublishedErrorModel, DoesNotContainTheCompleteOne) {
  const LinkageSettings settings = TestLinkage();
  const Eigen::MatrixXd published = JacobianOver(PublishedErrorModel(settings, true), 100, 5);
  const LinkageModel complete = CompleteErrorModel(settings);
  const Eigen::MatrixXd J = JacobianOver(complete, 100, 5);
  const auto names = complete.Names();
  const Index rank = RankOf(published);
  for (const char* name : {"tilt.pivot_3_v", "eccentricity.pivot_2_sin_1", "compliance.pivot_3"}) {
    const auto at = std::find(names.begin(), names.end(), name) - names.begin();
    Eigen::MatrixXd with(published.rows(), published.cols() + 1);
    with << published, J.col(at);
    EXPECT_EQ(RankOf(with), rank + 1) << name;
  }
}

TEST(ErrorModels, HoldWhatHasNoTolerance) {
  const LinkageSettings settings =
      LinkageFrom(std::string(kLinkageText) + "[linkage.tolerance]\nlink_um = 0\npivot_um = 7\n");
  const LinkageModel model = PivotErrorModel(settings);
  EXPECT_TRUE(model.blocks()[0]["link_1"].held);
  EXPECT_EQ(model.blocks()[0]["link_1"].value, kLink1);
  EXPECT_FALSE(model.blocks()[3]["pivot_2_x"].held);
  EXPECT_EQ(model.blocks()[3]["pivot_2_x"].prior_sd, 7e-6);
}

TEST(ErrorModels, OfAFormTheChainDoesNotHaveAreRefusedWithAWayOut) {
  LinkageSettings settings = TestLinkage();
  settings.pivots.reset();
  settings.segments.clear();
  for (const ErrorModel model :
       {ErrorModel::kPivots, ErrorModel::kPublished, ErrorModel::kPublishedWithBearing}) {
    try {
      MakeLinkageModel(settings, model);
      ADD_FAILURE();
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("form = \"pivots\""));
      EXPECT_THAT(error.what(), HasSubstr("use the complete model"));
    }
  }
  EXPECT_NO_THROW(MakeLinkageModel(settings, ErrorModel::kComplete));
}

}  // namespace error_models_test
}  // namespace abbe::relm
