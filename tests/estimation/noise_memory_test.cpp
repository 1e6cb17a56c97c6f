// Noise with a short memory: the filter against the covariance it stands for, the fit against the
// noise that was drawn.
#include "estimation/noise_memory.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <utility>

#include "estimation/readings_at_rest.h"
#include "random/counter_random.h"

namespace abbe::estimation {
namespace noise_memory_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kStep = 0.05;  // s

MatrixXd CovarianceOf(const VectorXd& times, const NoiseMemory& noise) {
  MatrixXd V(times.size(), times.size());
  for (Index a = 0; a < V.rows(); ++a) {
    V.col(a) = noise.slow * noise.slow * (-(times.array() - times[a]).abs() / noise.time).exp();
  }
  V.diagonal().array() += noise.white * noise.white;
  return V;
}

TEST(MemoryFilter, WhitensTheCovarianceThatItStandsFor) {
  const VectorXd times{{0.0, 0.1, 0.15, 0.4, 0.45, 2.0, 2.1}};
  for (const NoiseMemory& noise :
       {NoiseMemory{0.3, 1.2, 0.4}, NoiseMemory{0.0, 1.0, 0.1}, NoiseMemory{2.0, 0.0, 1.0}}) {
    const MemoryFilter filter(times, noise);
    const MatrixXd V = CovarianceOf(times, noise), one = MatrixXd::Identity(7, 7);
    MatrixXd W = one, back = one, transposed = one;
    filter.Whiten(W);
    filter.Restore(back);
    filter.WhitenTransposed(transposed);
    constexpr double kRounding = 1e-12;
    EXPECT_LT((W * V * W.transpose() - one).norm(), kRounding);
    EXPECT_LT((W * back - one).norm(), kRounding);
    EXPECT_LT((W.transpose() - transposed).norm(), kRounding);
    EXPECT_NEAR(filter.log_determinant(), std::log(V.determinant()), kRounding);
    EXPECT_LT((filter.Weights() - V.inverse().diagonal()).norm(), 1e-10);
  }
}

// Stays of `each` readings with a mean of their own, drawn with the Cholesky factor of V.
std::vector<Stay> Drawn(const NoiseMemory& noise, int stays, Index each, std::uint64_t stream,
                        double amplitude = 0.0, double frequency = 0.0) {
  const random::CounterRandom random(3, stream);
  std::vector<Stay> drawn;
  std::uint64_t index = 0;
  for (int i = 0; i < stays; ++i) {
    Stay stay{VectorXd::LinSpaced(each, 0.0, kStep * static_cast<double>(each - 1)),
              VectorXd(each)};
    for (double& value : stay.value) value = random.Normal(index++);
    stay.value = CovarianceOf(stay.time, noise).llt().matrixL() * stay.value;
    stay.time.array() += i * (kStep * static_cast<double>(each) + 0.73);
    stay.value.array() += 40.0 * random.Normal(index++);
    stay.value.array() +=
        amplitude * (2.0 * std::numbers::pi * frequency * stay.time).array().sin();
    drawn.push_back(stay);
  }
  return drawn;
}

TEST(FitMemory, FindsTheMemoryThatWasDrawn) {
  for (const double steps : {3.0, 10.0, 30.0}) {
    const NoiseMemory noise{0.5, 1.0, steps * kStep};
    const MemoryFit fit = FitMemory(Drawn(noise, 2, 600, 1));
    EXPECT_GT(fit.gain, 20.0);
    // 1200 readings hold some 1200 / (2 steps) independent values of the memory.
    const double doubt = 4.0 * std::sqrt(2.0 * steps / 1200.0);
    EXPECT_NEAR(fit.noise.slow, 1.0, 0.15 + doubt) << steps;
    EXPECT_NEAR(fit.noise.white, 0.5, 0.15) << steps;
    EXPECT_NEAR(std::log(fit.noise.time / noise.time), 0.0, std::log(1.5) + 2.0 * doubt) << steps;
  }
}

TEST(ReadingsAtRest, TellWhiteNoiseMemoryAndLinesApart) {
  for (std::uint64_t stream = 10; stream < 40; ++stream) {
    const RestNoise white = NoiseAtRest(Drawn({0.7, 0.0, 1.0}, 20, 8, stream));
    EXPECT_EQ(white.kind, RestKind::kWhite) << stream;
    EXPECT_NEAR(white.sd, 0.7, 0.7 * 4.0 / std::sqrt(2.0 * white.freedom));
    const RestNoise memory = NoiseAtRest(Drawn({0.2, 1.0, 5.0 * kStep}, 12, 25, stream));
    EXPECT_EQ(memory.kind, RestKind::kMemory) << stream;
    EXPECT_NEAR(memory.sd, 1.02, 1.02 * 4.0 / std::sqrt(2.0 * memory.freedom));
    const RestNoise line = NoiseAtRest(Drawn({0.5, 0.0, 1.0}, 12, 25, stream, 1.5, 4.07));
    EXPECT_EQ(line.kind, RestKind::kLine) << stream;
    EXPECT_NEAR(line.sd, 0.5, 0.5 * 4.0 / std::sqrt(2.0 * line.freedom));
    EXPECT_NEAR(line.scatter, std::sqrt(0.25 + 0.5 * 1.5 * 1.5), 0.2);
  }
}

// Readings whose pace is not quite even have no alias of the mains below half their rate.
TEST(ReadingsAtRest, KnowTheMainsBeyondHalfTheirRate) {
  constexpr Index kReadings = 400;
  constexpr double kHum = 0.4, kWhite = 0.02;
  for (const double mains : {50.0, 60.03}) {
    const random::CounterRandom random(7, 3);
    Stay stay{VectorXd(kReadings), VectorXd(kReadings)};
    for (Index i = 0; i < kReadings; ++i) {
      stay.time[i] = 0.09 * static_cast<double>(i) + random.Uniform(2 * i, 0.0, 1e-3);
      stay.value[i] = kWhite * random.Normal(2 * i + 1) +
                      kHum * std::sin(2.0 * std::numbers::pi * mains * stay.time[i]);
    }
    const RestNoise noise = NoiseAtRest({stay});
    EXPECT_EQ(noise.kind, RestKind::kLine);
    EXPECT_NEAR(noise.frequency, mains, 0.02);
    EXPECT_LT(noise.sd, 2.0 * kWhite);
  }
}

// Between two frequencies that are tried, a sine far above its noise leaves much more than that: a
// memory of the readings must not be told for it.
TEST(ReadingsAtRest, FindLinesFarAboveTheirNoise) {
  constexpr double kWhite = 0.02;
  for (std::uint64_t stream = 60; stream < 80; ++stream) {
    const double frequency = 0.5 + 0.0137 * static_cast<double>(stream - 60);
    for (const double over : {5.0, 20.0, 100.0}) {
      const RestNoise line =
          NoiseAtRest(Drawn({kWhite, 0.0, 1.0}, 1, 640, stream, over * kWhite, frequency));
      EXPECT_EQ(line.kind, RestKind::kLine) << stream << " " << over;
      EXPECT_NEAR(line.sd, kWhite, kWhite * 4.0 / std::sqrt(2.0 * line.freedom)) << over;
    }
  }
}

// Mains and a vibration in one channel: the noise is what both leave.
TEST(ReadingsAtRest, TakeOutSeveralLines) {
  constexpr double kWhite = 0.02;
  for (std::uint64_t stream = 80; stream < 90; ++stream) {
    std::vector<Stay> stays = Drawn({kWhite, 0.0, 1.0}, 1, 640, stream, 0.3, 6.1);
    for (const auto& [amplitude, frequency] : {std::pair{0.15, 0.553}, std::pair{0.08, 3.37}}) {
      stays[0].value.array() +=
          amplitude * (2.0 * std::numbers::pi * frequency * stays[0].time).array().cos();
    }
    const RestNoise line = NoiseAtRest(stays);
    EXPECT_EQ(line.kind, RestKind::kLine) << stream;
    EXPECT_NEAR(line.frequency, 6.1, 0.01);
    EXPECT_NEAR(line.sd, kWhite, kWhite * 4.0 / std::sqrt(2.0 * line.freedom)) << stream;
  }
}

TEST(ReadingsAtRest, LeaveOneReadingThatStandsOutAside) {
  std::vector<Stay> stays = Drawn({1.0, 0.0, 1.0}, 1, 200, 50);
  stays[0].value[70] += 40.0;
  const RestNoise noise = NoiseAtRest(stays);
  EXPECT_NEAR(noise.sd, 1.0, 4.0 / std::sqrt(2.0 * noise.freedom));
}

}  // namespace noise_memory_test
}  // namespace abbe::estimation
