#include "map/error_map.h"

#include "failure/failure.h"
#include "map_cases.h"

namespace abbe::map {
namespace error_map_test {

using Eigen::Vector3d;

TEST(ErrorMap, NamesThe21ErrorsAndAllItsParameters) {
  EXPECT_EQ(ErrorName(0), "EXX");
  EXPECT_EQ(ErrorName(10), "EBY");
  EXPECT_EQ(ErrorName(20), "C0Y");
  EXPECT_THROW(ErrorName(21), InputError);
  const auto names = RandomMap(1).ParameterNames();
  EXPECT_EQ(names.size(), 18 * 8 + 3);
  EXPECT_EQ(names.front(), "EXX.c0");
  EXPECT_EQ(names.back(), "squareness.C0Y");
}

// Parameters drawn from the covariance, sent through the exact model, scatter as the map says.
TEST(ErrorMap, TheStatedCovarianceIsThatOfDrawnMachines) {
  const ErrorMap map = RandomMap(3);
  const Vector3d place(0.041, 0.013, 0.055), tool(0.03, 0.01, -0.1);
  machine::VolumetricModel drawn = map.model();
  constexpr int kDraws = 2000;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int i = 0; i < kDraws; ++i) {
    drawn.SetParameters(DrawParameters(map, 100 + i));
    const Vector3d d = drawn.Error(place, tool) - map.Error(place, tool);
    sum += d * d.transpose();
  }
  const Eigen::Matrix3d cov = map.Covariance(place, tool);
  const double scale = cov.trace();
  // A variance of n draws scatters by sqrt(2/n); 4 of these.
  const double band = 4 * std::sqrt(2.0 / kDraws);
  EXPECT_LT((sum / kDraws - cov).cwiseAbs().maxCoeff(), band * scale);
  EXPECT_GT(cov.diagonal().minCoeff(), 0.02 * scale);
}

TEST(ErrorMap, NothingIsExtrapolated) {
  const ErrorMap map = RandomMap(1);
  for (const double x : {-1e-9, 0.0601}) {
    ExpectHas(MessageOf<InputError>([&] {
                map.Error({x, 0.01, 0.01}, Vector3d::Zero());
              }),
              "outside its travel");
    ExpectHas(MessageOf<InputError>([&] {
                map.Covariance({x, 0.01, 0.01}, Vector3d::Zero());
              }),
              "outside its travel");
  }
}

TEST(ErrorMap, ABadCovarianceIsRefusedByName) {
  const ErrorMap map = RandomMap(1);
  const auto with = [&](Eigen::MatrixXd cov) {
    return MessageOf<InputError>([&] { ErrorMap(map.origin(), map.model(), std::move(cov)); });
  };
  Eigen::MatrixXd cov = map.cov_pp();
  cov(3, 3) = -1e-12;
  ExpectHas(with(cov), "variance of EXX.c3 is negative");
  cov(3, 3) = std::nan("");
  ExpectHas(with(cov), "EXX.c3 is not finite");
  cov = map.cov_pp();
  cov(0, 1) += 1e-3 * cov(0, 0);
  ExpectHas(with(cov), "not symmetric");
  ExpectHas(with(cov.topRows(5)), "5 x 147");
}

TEST(ErrorMap, AMapWithoutCovarianceSaysSo) {
  const ErrorMap map = RandomMap(1);
  const ErrorMap bare(map.origin(), map.model(), {});
  EXPECT_FALSE(bare.StatesUncertainty());
  ExpectHas(MessageOf<InputError>([&] {
              bare.StandardUncertainty({0.01, 0.01, 0.01}, Vector3d::Zero());
            }),
            "has no uncertainty");
}

}  // namespace error_map_test
}  // namespace abbe::map
