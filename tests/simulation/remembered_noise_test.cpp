// A run whose noise goes on from one row to the next, against the covariance that it stands for.
#include "simulation/remembered_noise.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <memory>

#include "simulation/stage_response.h"

namespace abbe::simulation {
namespace remembered_noise_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kInstants = 6, kChannels = 2, kRows = kInstants * kChannels;

MatrixXd Numbers(Index rows, Index columns, double seed) {
  MatrixXd numbers(rows, columns);
  for (Index i = 0; i < numbers.size(); ++i) {
    numbers(i) = std::sin(seed + 1.7 * static_cast<double>(i));
  }
  return numbers;
}

class PlainResponse : public StageResponse {
 public:
  PlainResponse() : StageResponse(Numbers(kRows, 2, 0.3), kChannels) {}
  MatrixXd Readings(const VectorXd& left) const override {
    return -left.reshaped(kChannels, kInstants);
  }
};

// r = A x, both channels of an instant beside each other.
class Plain : public Responsive {
 public:
  Index Rows() const override { return kRows; }
  void Evaluate(const VectorXd& x, VectorXd& values,
                estimation::RowMatrix* jacobian) const override {
    values = A_ * x;
    if (jacobian != nullptr) *jacobian = A_;
  }
  std::shared_ptr<const Response> At(const VectorXd&) const override {
    return std::make_shared<PlainResponse>();
  }

 private:
  MatrixXd A_ = Numbers(kRows, 3, 2.0);
};

const VectorXd kTimes{{0.0, 0.1, 0.25, 0.3, 0.9, 1.0}};
const estimation::NoiseMemory kNoise{0.6, 0.9, 0.3};

// The rows: the channels are independent of each other.
MatrixXd Covariance() {
  MatrixXd V = MatrixXd::Zero(kRows, kRows);
  for (Index a = 0; a < kInstants; ++a) {
    for (Index b = 0; b < kInstants; ++b) {
      const double slow = 0.81 * std::exp(-std::abs(kTimes[a] - kTimes[b]) / 0.3);
      for (Index k = 0; k < kChannels; ++k) {
        V(a * kChannels + k, b * kChannels + k) = slow + (a == b ? 0.36 : 0.0);
      }
    }
  }
  return V;
}

struct Runs {
  SimulatedRun plain, remembers;
};

Runs Made() {
  SimulatedRun plain{"run", "plain", {}, nullptr};
  const auto residual = std::make_shared<Plain>();
  plain.residual = plain.response = residual;
  return {plain, WithMemory(plain, kTimes, kNoise)};
}

constexpr double kRounding = 1e-12;

TEST(RememberedNoise, WeighsResidualsByTheInverseOfTheirCovariance) {
  const Runs runs = Made();
  const VectorXd x{{0.4, -1.0, 2.0}};
  VectorXd r(kRows), white(kRows);
  estimation::RowMatrix J(kRows, 3), white_J(kRows, 3);
  runs.plain.residual->Evaluate(x, r, &J);
  runs.remembers.residual->Evaluate(x, white, &white_J);
  const MatrixXd weight = Covariance().inverse();
  EXPECT_NEAR(white.squaredNorm(), r.dot(weight * r), kRounding * white.squaredNorm());
  EXPECT_LT((white_J.transpose() * white - J.transpose() * weight * r).norm(), 1e-10);
}

TEST(RememberedNoise, TellsOfDisturbancesAndReadingsAsTheRunDoes) {
  const Runs runs = Made();
  const auto plain = runs.plain.response->At({}), remembers = runs.remembers.response->At({});
  const VectorXd left = Numbers(kRows, 1, 5.0);
  Disturbance disturbance(kInstants);
  disturbance.row(1) = Numbers(1, kInstants, 7.0);
  const MatrixXd column = remembers->Columns({disturbance});
  const MatrixXd back = remembers->BackToReadings(left);
  EXPECT_NEAR(column.col(0).dot(left), (disturbance.row(1) * remembers->BackToStage(1, back))(0),
              kRounding * left.norm());
  // Readings follow from what is left before it was whitened.
  VectorXd white(kRows), r(kRows);
  const VectorXd x{{1.0, 0.5, -0.2}};
  runs.plain.residual->Evaluate(x, r, nullptr);
  runs.remembers.residual->Evaluate(x, white, nullptr);
  EXPECT_LT((remembers->Readings(white) - plain->Readings(r)).norm(), 1e-10);
  const VectorXd diagonal = Covariance().inverse().diagonal();
  const double first = Numbers(kRows, 2, 0.3).col(1).head(kChannels).squaredNorm() * diagonal[0];
  EXPECT_NEAR(remembers->WeightsOf(1)[0], first, 1e-10);
}

TEST(RememberedNoise, KnowsTheChannelsOfWhatIsLeft) {
  const auto channels = ChannelsOf(VectorXd::LinSpaced(kRows, 0.0, kRows - 1.0), kTimes);
  ASSERT_EQ(channels.size(), 2u);
  EXPECT_EQ(channels[1].value[2], 5.0);
  EXPECT_EQ(channels[1].time, kTimes);
}

}  // namespace remembered_noise_test
}  // namespace abbe::simulation
