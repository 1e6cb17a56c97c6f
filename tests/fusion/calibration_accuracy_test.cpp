// Are the uncertainties of a calibration true, and could anybody do better? One world a seed
// (tests/seeds.h). Worlds, readings and the bound come from plain matrix products
// (tests/relm/linkage_by_matrices.h) and share no model with the program.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <cmath>

#include "fusion/calibrate.h"
#include "linkage_world.h"
#include "random/counter_random.h"
#include "tests/pull_statistics.h"
#include "tests/relm/linkage_by_matrices.h"
#include "tests/seeds.h"

namespace abbe::fusion {
namespace calibration_accuracy_test {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using relm::ErrorModel;

// The linkage on a perfect machine, its parameters in the order of the program's free ones.
class MatrixWorld {
 public:
  MatrixWorld(const relm::LinkageSettings& settings, ErrorModel model)
      : model_(model), base_(settings.X_MB.p), settings_(settings) {
    const simulation::LinkageSimulation names(WorldChain(), settings,
                                              relm::MakeLinkageModel(settings, model));
    for (const auto& block : names.Blocks()) {
      for (std::size_t i = 0; i < block.entries.size(); ++i) {
        fixed_[block.FullName(i)] = block.entries[i].nominal;
        if (block.entries[i].held) continue;
        names_.push_back(block.FullName(i));
        nominal_.push_back(block.entries[i].nominal);
        prior_.push_back(block.entries[i].prior_sd);
      }
    }
  }

  const std::vector<std::string>& names() const { return names_; }
  VectorXd nominal() const { return Eigen::Map<const VectorXd>(nominal_.data(), Size()); }
  VectorXd prior() const { return Eigen::Map<const VectorXd>(prior_.data(), Size()); }
  Index Size() const { return static_cast<Index>(names_.size()); }

  VectorXd Draw(std::uint64_t seed) const {
    const random::CounterRandom random(seed, 0xCA1);
    VectorXd x = nominal();
    for (Index i = 0; i < Size(); ++i) {
      x[i] += prior_[static_cast<std::size_t>(i)] * random.Normal(static_cast<std::uint64_t>(i));
    }
    return x;
  }

  relm::Named<double> With(const VectorXd& x) const {
    relm::Named<double> named = fixed_;
    for (Index i = 0; i < Size(); ++i) named[names_[static_cast<std::size_t>(i)]] = x[i];
    return named;
  }

  Vector3d Ball(const relm::Named<double>& x, const Vector3d& q) const {
    const Vector3d turn(x.at("base_turn.a"), x.at("base_turn.b"), x.at("base_turn.c"));
    const double angle = turn.norm();
    const Matrix3d R = angle > 0.0 ? Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix()
                                   : Matrix3d(Matrix3d::Identity());
    const Vector3d p_BT = model_ == ErrorModel::kComplete
                              ? relm::CompleteTipByMatrices<double>(q.data(), 0.0, x)
                              : relm::PublishedTipByMatrices<double>(q.data(), 0.0, x);
    return base_ + Vector3d(x.at("base.x"), x.at("base.y"), x.at("base.z")) + R * p_BT;
  }

  Matrix3d Slope(const relm::Named<double>& x, const Vector3d& q) const {
    constexpr double kStep = 1e-5;
    Matrix3d J;
    for (int i = 0; i < 3; ++i) {
      const Vector3d h = kStep * Vector3d::Unit(i);
      J.col(i) = (Ball(x, q + h) - Ball(x, q - h)) / (2.0 * kStep);
    }
    return J;
  }

  // Encoder readings with the ball at p_MT; `near` is good to some mrad, so each step with the
  // slope there leaves a hundredth.
  Vector3d Readings(const relm::Named<double>& x, const Vector3d& p_MT, Vector3d near) const {
    const Matrix3d inverse = Slope(x, near).inverse();
    for (int step = 0; step < 9; ++step) near += inverse * (p_MT - Ball(x, near));
    return near;
  }

  // d ball / d parameters, 3 rows a pose.
  MatrixXd Jacobian(const Matrix3Xd& angles) const {
    MatrixXd J(3 * angles.cols(), Size());
    for (Index i = 0; i < Size(); ++i) {
      const double step = 0.01 * prior_[static_cast<std::size_t>(i)];
      const auto high = With(nominal() + step * VectorXd::Unit(Size(), i));
      const auto low = With(nominal() - step * VectorXd::Unit(Size(), i));
      for (Index pose = 0; pose < angles.cols(); ++pose) {
        const Vector3d q = angles.col(pose);
        J.block<3, 1>(3 * pose, i) = (Ball(high, q) - Ball(low, q)) / (2.0 * step);
      }
    }
    return J;
  }

  const relm::LinkageSettings& settings() const { return settings_; }

 private:
  ErrorModel model_;
  Vector3d base_;
  relm::LinkageSettings settings_;
  relm::Named<double> fixed_;
  std::vector<std::string> names_;
  std::vector<double> nominal_, prior_;
};

Matrix3Xd Places(const Matrix3Xd& positions) {
  Matrix3Xd p_MT = positions;
  p_MT.topRows<2>() *= -1.0;
  return p_MT;
}

Matrix3Xd NominalAngles(const relm::LinkageSettings& settings, const Matrix3Xd& positions) {
  const Matrix3Xd p_MT = Places(positions);
  Matrix3Xd q(3, p_MT.cols());
  for (Index i = 0; i < q.cols(); ++i) {
    q.col(i) = settings.pivots->Angles(p_MT.col(i) - settings.X_MB.p, settings.branch);
  }
  return q;
}

simulation::LinkageRun Measured(const MatrixWorld& world, const relm::Named<double>& x,
                                const Matrix3Xd& positions, bool noisy, std::uint64_t seed) {
  const auto& settings = world.settings();
  simulation::LinkageRun run = simulation::RunAt(positions, settings);
  const Matrix3Xd near = NominalAngles(settings, positions), p_MT = Places(positions);
  const random::CounterRandom random(seed, 0xCA2);
  for (Index pose = 0; pose < run.poses(); ++pose) {
    run.readings.angles.col(pose) = world.Readings(x, p_MT.col(pose), near.col(pose));
    for (int i = 0; noisy && i < 3; ++i) {
      const auto index = static_cast<std::uint64_t>(6 * pose + i);
      run.readings.angles(i, pose) += settings.noise.encoder * random.Normal(index);
      run.reference(i, pose) += settings.noise.reference * random.Normal(index + 3);
    }
  }
  return run;
}

// The least covariance that the parameters can have, given the data and what is known beforehand.
MatrixXd Bound(const MatrixWorld& world, const Matrix3Xd& positions) {
  const auto& noise = world.settings().noise;
  const Matrix3Xd q = NominalAngles(world.settings(), positions);
  const MatrixXd J = world.Jacobian(q);
  const auto nominal = world.With(world.nominal());
  MatrixXd information = world.prior().array().square().inverse().matrix().asDiagonal();
  for (Index pose = 0; pose < q.cols(); ++pose) {
    const Matrix3d slope = world.Slope(nominal, q.col(pose));
    const Matrix3d covariance = std::pow(noise.encoder, 2) * slope * slope.transpose() +
                                std::pow(noise.reference, 2) * Matrix3d::Identity();
    const MatrixXd rows = J.middleRows(3 * pose, 3);
    information += rows.transpose() * covariance.inverse() * rows;
  }
  const VectorXd scale = world.prior();
  const MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  return scale.asDiagonal() * scaled.llt().solve(MatrixXd::Identity(scale.size(), scale.size())) *
         scale.asDiagonal();
}

void Check(ErrorModel model, const Matrix3Xd& positions, const Vector3d& volume) {
  const MatrixWorld world(WorldSettings(), model);
  const Matrix3Xd places = RandomPositions(volume, 40, 1);
  const MatrixXd J = world.Jacobian(NominalAngles(world.settings(), places));
  const double bound = ((J * Bound(world, positions)).cwiseProduct(J)).sum();
  Mean pull, distance, to_bound;
  const Seeds seeds = SeedsFromEnvironment();
  const auto n = static_cast<double>(world.Size());
  for (auto seed = seeds.first; seed <= seeds.last; seed += seeds.step) {
    const VectorXd truth = world.Draw(seed);
    const auto named = world.With(truth);
    const auto report =
        Calibrate(WorldChain(), world.settings(), {Measured(world, named, positions, true, seed)},
                  {.model = model, .folds = 1});
    ASSERT_EQ(report.fit.names, world.names());
    VectorXd error(world.Size());
    for (Index i = 0; i < error.size(); ++i) {
      error[i] = report.fit.Value(world.names()[static_cast<std::size_t>(i)]) - truth[i];
    }
    const VectorXd scale = world.prior();
    const MatrixXd covariance = scale.cwiseInverse().asDiagonal() * report.fit.covariance *
                                scale.cwiseInverse().asDiagonal();
    const VectorXd scaled = error.cwiseQuotient(scale);
    distance.Add(scaled.dot(covariance.llt().solve(scaled)) / n);
    pull.Add(error.cwiseQuotient(report.fit.covariance.diagonal().cwiseSqrt()).squaredNorm() / n);
    const auto other = Measured(world, named, places, false, seed);
    const CalibratedLinkage linkage(world.settings(), report.calibration);
    to_bound.Add((linkage.Tips(other.readings) - Places(places)).squaredNorm() / bound);
  }
  const double ratio = std::sqrt(to_bound.mean());
  fmt::print(
      "{} parameters, {} poses, {} seeds: pulls have variance {:.3f} +- {:.3f}, all together "
      "{:.3f} "
      "+- {:.3f}; rms 3D error / bound {:.3f} +- {:.3f} (the bound: {:.3f} um)\n",
      world.Size(), positions.cols(), pull.count, pull.mean(), pull.error(), distance.mean(),
      distance.error(), ratio, to_bound.error() / (2.0 * ratio),
      1e6 * std::sqrt(bound / static_cast<double>(places.cols())));
  EXPECT_NEAR(pull.mean(), 1.0, k99 * pull.error());
  EXPECT_LT(k99 * pull.error(), 0.15);  // so a pull of 1.1 (variance 1.21) fails
  // Chi-squared with n degrees of freedom in every seed.
  EXPECT_NEAR(distance.mean(), 1.0, k99 * std::sqrt(2.0 / (n * distance.count)) + kOfProducts / n);
  // Half of the 10 % that may be lost is the limit; nobody is better than the bound.
  EXPECT_LT(ratio, 1.05);
  EXPECT_LT(k99 * to_bound.error(), 0.15);
  EXPECT_GT(to_bound.mean(), 1.0 - 4.0 * to_bound.error());
}

TEST(CalibrationAccuracy, OfTheCompleteModelOverTheTravel) {
  const Vector3d travel(0.060, 0.060, 0.060);
  Check(ErrorModel::kComplete, GridPositions(travel, {5, 5, 5}), travel);
}

TEST(CalibrationAccuracy, OfThePublishedModelInThePublishedCube) {
  const Vector3d cube(0.025, 0.025, 0.050);
  Check(ErrorModel::kPublishedWithBearing, GridPositions(cube, {5, 5, 8}), cube);
}

}  // namespace calibration_accuracy_test
}  // namespace abbe::fusion
