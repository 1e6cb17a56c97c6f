#include "estimation/markov_noise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <vector>

#include "failure/failure.h"
#include "random/counter_random.h"

namespace abbe::estimation {
namespace markov_noise_test {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using random::CounterRandom;

struct Campaign {
  std::vector<double> times;
  std::vector<int> groups;
  std::vector<double> white;
  int group_count = 0;
};

// Stations there and back `passes` times, at uneven times.
Campaign Sweep(int stations, int passes, double white) {
  Campaign c;
  c.group_count = stations;
  const CounterRandom jitter(3, 0);
  double time = 10.0;
  for (int p = 0; p < passes; ++p) {
    for (int i = 0; i < stations; ++i) {
      c.groups.push_back(p % 2 == 0 ? i : stations - 1 - i);
      c.times.push_back(time += 1.0 + 2.0 * jitter.Uniform(c.times.size()));
      c.white.push_back(white * (0.5 + jitter.Uniform(c.times.size() + 100000)));
    }
  }
  return c;
}

MatrixXd DriftMatrix(const Campaign& c, double sd, double tau) {
  const auto n = static_cast<Eigen::Index>(c.times.size());
  MatrixXd v(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      v(i, j) = sd * sd * std::exp(-std::abs(c.times[size_t(i)] - c.times[size_t(j)]) / tau);
    }
  }
  return v;
}

MatrixXd GroupMatrix(const Campaign& c) {
  MatrixXd a = MatrixXd::Zero(static_cast<Eigen::Index>(c.times.size()), c.group_count);
  for (size_t k = 0; k < c.groups.size(); ++k) a(Eigen::Index(k), c.groups[k]) = 1.0;
  return a;
}

// A drift and white noise with the covariance V, from a Cholesky factor: not the recursion under
// test.
MatrixXd Draw(const Campaign& c, double sd, double tau, int columns, std::uint64_t seed) {
  const VectorXd white = Eigen::Map<const VectorXd>(c.white.data(), Eigen::Index(c.white.size()));
  MatrixXd v = DriftMatrix(c, sd, tau);
  v += white.asDiagonal();
  const MatrixXd factor = v.llt().matrixL();
  MatrixXd normal(v.rows(), columns);
  for (int j = 0; j < columns; ++j) {
    const CounterRandom noise(seed, std::uint64_t(j));
    for (Eigen::Index i = 0; i < v.rows(); ++i) normal(i, j) = noise.Normal(std::uint64_t(i));
  }
  return factor * normal;
}

MarkovNoiseFit Fit(const Campaign& c, const MatrixXd& values, double sd, double tau) {
  return FitGroupsUnderDrift(c.times, c.groups, values, c.white, sd, tau, c.group_count);
}

TEST(MarkovNoise, AgreesWithTheDenseSolution) {
  const Campaign c = Sweep(9, 4, 0.04);
  constexpr double kSd = 0.7, kTau = 25.0;
  const MatrixXd a = GroupMatrix(c);
  const MatrixXd y = Draw(c, kSd, kTau, 3, 1) + a * MatrixXd::Random(c.group_count, 3) * 5.0;
  const auto fit = Fit(c, y, kSd, kTau);

  const MatrixXd r = DriftMatrix(c, kSd, kTau);
  MatrixXd v = r;
  v += Eigen::Map<const VectorXd>(c.white.data(), v.rows()).asDiagonal();
  const MatrixXd vi = v.inverse();
  const MatrixXd information = a.transpose() * vi * a;
  const MatrixXd covariance = information.inverse();
  const MatrixXd m = covariance * a.transpose() * vi * y;
  const MatrixXd off = y - a * m;
  const MatrixXd drift = r * vi * off;
  // Two ways to solve systems of condition 1e3 in double precision.
  constexpr double kRounding = 1e-10;
  EXPECT_LT((fit.values - m).norm(), kRounding);
  EXPECT_LT((fit.covariance - covariance).norm(), kRounding);
  EXPECT_LT((fit.drift - drift).norm(), kRounding);
  EXPECT_LT((fit.residuals - (off - drift)).norm(), kRounding);
  EXPECT_EQ(fit.freedom, 27);
  for (int j = 0; j < 3; ++j) {
    const double chi = off.col(j).dot(vi * off.col(j));
    EXPECT_NEAR(fit.chi_square[j], chi, kRounding * chi);
    const double log_density =
        -0.5 * (chi + 27.0 * std::log(2.0 * std::numbers::pi) + std::log(v.determinant()) +
                std::log(information.determinant()));
    EXPECT_NEAR(fit.log_restricted_likelihood[j], log_density, 1e-8);
  }
}

TEST(MarkovNoise, WithoutDriftItIsTheWeightedMean) {
  const Campaign c{{0, 1, 2, 3}, {0, 1, 0, 1}, {1.0, 2.0, 3.0, 2.0}, 2};
  const auto fit = Fit(c, Eigen::Vector4d(1.0, 4.0, 5.0, 8.0), 0.0, 0.0);
  EXPECT_NEAR(fit.values(0, 0), (1.0 + 5.0 / 3.0) / (1.0 + 1.0 / 3.0), 1e-14);
  EXPECT_NEAR(fit.values(1, 0), 6.0, 1e-14);
  EXPECT_NEAR(fit.covariance(0, 0), 0.75, 1e-14);
  EXPECT_NEAR(fit.covariance(1, 1), 1.0, 1e-14);
  EXPECT_NEAR(fit.covariance(0, 1), 0.0, 1e-14);
  EXPECT_NEAR(fit.chi_square[0], 4.0 + 16.0 / 4.0, 1e-13);
  EXPECT_EQ(fit.drift.norm(), 0.0);
}

TEST(MarkovNoise, OneReadingOfEachGroupHasTheVarianceOfReadingAndDrift) {
  // G = K: m = y, cov = V: closed form.
  const Campaign c{{0.0, 1.0, 3.0}, {0, 1, 2}, {0.1, 0.2, 0.3}, 3};
  const Eigen::Vector3d y(1.0, 2.0, 3.0);
  const auto fit = Fit(c, y, 0.5, 2.0);
  EXPECT_LT((fit.values - y).norm(), 1e-12);
  EXPECT_NEAR(fit.covariance(0, 0), 0.1 + 0.25, 1e-12);
  EXPECT_NEAR(fit.covariance(0, 1), 0.25 * std::exp(-0.5), 1e-12);
  EXPECT_NEAR(fit.covariance(0, 2), 0.25 * std::exp(-1.5), 1e-12);
}

TEST(MarkovNoise, AShortCampaignLeavesTheCommonConstantToTheDriftsPrior) {
  // All readings within 1e-3 of tau: the drift is one constant; it raises every variance by s^2 and
  // no difference.
  const Campaign c = Sweep(5, 6, 0.01);
  const double tau = 1e3 * (c.times.back() - c.times.front());
  const auto still = Fit(c, MatrixXd::Zero(30, 1), 0.0, tau);
  const auto fit = Fit(c, MatrixXd::Zero(30, 1), 2.0, tau);
  const VectorXd ones = VectorXd::Ones(5) / 5.0;
  // 2 s^2 T/tau = 0.008 is the variance of what drifts within the campaign.
  EXPECT_NEAR(ones.dot(fit.covariance * ones), 4.0 + ones.dot(still.covariance * ones), 0.008);
  VectorXd difference = VectorXd::Zero(5);
  difference << 1.0, -1.0, 0.0, 0.0, 0.0;
  EXPECT_LT(difference.dot(fit.covariance * difference),
            difference.dot(still.covariance * difference) + 2.0 * 0.008);
}

TEST(MarkovNoise, StatesTheSpreadOfItsAnswers) {
  const Campaign c = Sweep(7, 5, 0.09);
  constexpr int kDraws = 3000;
  const auto fit = Fit(c, Draw(c, 0.6, 15.0, kDraws, 77), 0.6, 15.0);
  const MatrixXd spread = fit.values * fit.values.transpose() / kDraws;
  // An element of a sample covariance has a standard deviation of sqrt((c_ij^2 + c_ii c_jj)/n).
  for (int i = 0; i < 7; ++i) {
    for (int j = 0; j <= i; ++j) {
      const auto& cov = fit.covariance;
      const double noise = std::sqrt((cov(i, j) * cov(i, j) + cov(i, i) * cov(j, j)) / kDraws);
      EXPECT_NEAR(spread(i, j), cov(i, j), 4.0 * noise);
    }
  }
  EXPECT_NEAR(fit.chi_square.mean() / double(fit.freedom), 1.0,
              4.0 * std::sqrt(2.0 / (double(fit.freedom) * kDraws)));
}

TEST(MarkovNoise, TheLikelihoodPrefersTheTruth) {
  const Campaign c = Sweep(7, 5, 0.09);
  const MatrixXd y = Draw(c, 0.6, 15.0, 400, 5);
  const double at_truth = Fit(c, y, 0.6, 15.0).log_restricted_likelihood.mean();
  for (const auto& [sd, tau] : {std::pair{0.3, 15.0}, {1.2, 15.0}, {0.6, 3.0}, {0.6, 100.0}}) {
    EXPECT_LT(Fit(c, y, sd, tau).log_restricted_likelihood.mean(), at_truth);
  }
}

TEST(MarkovNoise, CarriesManyReadings) {
  const Campaign c = Sweep(61, 200, 1.0);
  const auto fit = Fit(c, MatrixXd::Constant(12200, 5, 3.0), 1.0, 100.0);
  EXPECT_LT((fit.values.array() - 3.0).abs().maxCoeff(), 1e-9);
}

TEST(MarkovNoise, RefusesWhatItCannotUse) {
  const auto refuses = [](const Campaign& c, double sd, double tau, const char* words) {
    try {
      Fit(c, MatrixXd::Zero(Eigen::Index(c.times.size()), 1), sd, tau);
      ADD_FAILURE() << words;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(words));
    }
  };
  refuses({{0, 0}, {0, 0}, {1, 1}, 1}, 1.0, 1.0, "time 0 of reading 1 is not after");
  refuses({{0, 1}, {0, 2}, {1, 1}, 2}, 1.0, 1.0, "reading 1 is of group 2");
  refuses({{0, 1}, {0, 0}, {1, 0}, 1}, 1.0, 1.0, "white variance 0 of reading 1");
  refuses({{0, 1}, {0, 2}, {1, 1}, 3}, 1.0, 1.0, "group 1 has no reading");
  refuses({{0, 1}, {0, 0}, {1, 1}, 1}, 1.0, 0.0, "time > 0");
  refuses({{0, 1}, {0, 0}, {1}, 1}, 1.0, 1.0, "1 variances");
}

}  // namespace markov_noise_test
}  // namespace abbe::estimation
