#include "fusion/place_scatter.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "../folders.h"
#include "fusion/machine_prior.h"
#include "machine/machine.h"
#include "random/counter_random.h"
#include "settings/document.h"

namespace abbe::fusion {
namespace place_scatter_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kTravel = 0.060;
constexpr double kNoise = 0.2e-6;  // m, a component

// A ball in space with three encoders that turn it about places of their own: three rows a pose.
class BallInSpace : public simulation::Response {
 public:
  explicit BallInSpace(const MatrixXd& places) : places_(places) {}

  MatrixXd Columns(const std::vector<simulation::Disturbance>& disturbances) const override {
    MatrixXd columns = MatrixXd::Zero(places_.size(), std::ssize(disturbances));
    for (Index d = 0; d < columns.cols(); ++d) {
      for (const auto& [stage, values] : disturbances[d].stages()) {
        for (Index pose = 0; pose < places_.cols(); ++pose) {
          columns.col(d).segment<3>(3 * pose) += By(stage, pose) * values[pose] / kNoise;
        }
      }
    }
    return columns;
  }
  // m for each m or rad.
  Vector3d By(Index stage, Index pose) const {
    for (Index axis = 0; axis < 3; ++axis) {
      if (stage == simulation::MotionStage(axis, axis)) return Vector3d::Unit(axis);
    }
    const Index encoder = stage - simulation::kEncoderStage;
    if (encoder < 0 || encoder > 2) return Vector3d::Zero();
    const Vector3d arm = places_.col(pose) - Vector3d(0.2, -0.1, 0.05);
    return Vector3d::Unit(encoder).cross(arm);
  }
  MatrixXd Readings(const VectorXd&) const override { return {}; }
  MatrixXd BackToReadings(const MatrixXd& left) const override { return left; }
  MatrixXd BackToStage(Index, const MatrixXd& back) const override { return back; }
  RowVectorXd WeightsOf(Index) const override { return RowVectorXd::Ones(places_.cols()); }
  bool RowsAreIndependent() const override { return true; }

 private:
  const MatrixXd places_;
};

class OneResponse : public simulation::Responsive {
 public:
  explicit OneResponse(std::shared_ptr<const BallInSpace> response)
      : response_(std::move(response)) {}

  Index Rows() const override { return 0; }
  void Evaluate(const VectorXd&, VectorXd&, estimation::RowMatrix*) const override {}
  std::shared_ptr<const simulation::Response> At(const VectorXd&) const override {
    return response_;
  }

 private:
  const std::shared_ptr<const BallInSpace> response_;
};

// Five places along each axis, each up to a millimetre off its grid.
class PlaceScatterTest : public testing::Test {
 protected:
  explicit PlaceScatterTest()
      : machine_(machine::ReadMachine(settings::Document::Read(DemoMillFile()).Root())),
        model_(UnknownMachine(machine_)),
        prior_(machine_, model_, PopulationOf(machine_)) {}

  void Place(std::uint64_t seed) {
    const random::CounterRandom draw(seed, 1);
    places_.resize(3, 125);
    for (Index pose = 0; pose < places_.cols(); ++pose) {
      const Eigen::Array3d grid(pose % 5, pose / 5 % 5, pose / 25);
      for (int axis = 0; axis < 3; ++axis) {
        places_(axis, pose) =
            0.0015 + 0.01425 * grid[axis] +
            draw.Uniform(static_cast<std::uint64_t>(3 * pose + axis), -1e-3, 1e-3);
      }
    }
    response_ = std::make_shared<BallInSpace>(places_);
  }
  VectorXd Noise(std::uint64_t seed, double times) const {
    const random::CounterRandom draw(seed, 2);
    VectorXd noise(places_.size());
    for (Index row = 0; row < noise.size(); ++row) {
      noise[row] = times * draw.Normal(static_cast<std::uint64_t>(row));
    }
    return noise;
  }
  // One for each pose, of deviation 1.
  RowVectorXd Scatter(std::uint64_t seed, int stream) const {
    const random::CounterRandom draw(seed, static_cast<std::uint64_t>(stream));
    RowVectorXd scatter(places_.cols());
    for (Index pose = 0; pose < scatter.size(); ++pose) {
      scatter[pose] = draw.Normal(static_cast<std::uint64_t>(pose));
    }
    return scatter;
  }
  // What is left with so much in a stage.
  VectorXd Left(std::uint64_t seed, Index stage, const RowVectorXd& values) const {
    simulation::Disturbance there(places_.cols());
    there.row(stage) = values;
    return Noise(seed, 1.0) + response_->Columns({there});
  }
  PlaceScatter Find(const VectorXd& left) const {
    simulation::SimulatedRun run{"space", "linkage", {}, nullptr};
    run.response = std::make_shared<OneResponse>(response_);
    run.commanded = places_;
    return FindPlaceScatter(run, left, model_, prior_);
  }

  const machine::Machine machine_;
  const machine::VolumetricModel model_;
  const MachinePrior prior_;
  MatrixXd places_;
  std::shared_ptr<const BallInSpace> response_;
};

// 3 um, a period of 5 to 12 mm, seen on five layers of 2 mm.
TEST_F(PlaceScatterTest, NamesTheAxisOfAWaveAndItsSize) {
  constexpr int kWorlds = 30;
  constexpr double kAmplitude = 3e-6;
  double logs = 0.0;
  for (std::uint64_t seed = 1; seed <= kWorlds; ++seed) {
    SCOPED_TRACE(seed);
    Place(seed);
    const random::CounterRandom draw(seed, 3);
    const int axis = static_cast<int>(seed % 3);
    const double period = draw.Uniform(0, 5e-3, 12e-3), phase = draw.Uniform(1, 0.0, 6.28);
    const RowVectorXd wave =
        kAmplitude *
        (2.0 * std::numbers::pi / period * places_.row(axis).array() + phase).sin().matrix();
    const PlaceScatter found = Find(Left(seed, simulation::MotionStage(axis, axis), wave));
    ASSERT_EQ(found.axis, axis);
    const double off = std::log(found.sd / (kAmplitude / std::numbers::sqrt2));
    EXPECT_LT(std::abs(off), std::log(3.0));
    logs += off / kWorlds;
  }
  EXPECT_LT(std::abs(logs), std::log(1.5));
}

TEST_F(PlaceScatterTest, SaysNothingOfNoise) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(seed);
    Place(seed);
    EXPECT_EQ(Find(Noise(seed, 1.0)).axis, -1);
    EXPECT_EQ(Find(Noise(seed, 3.0)).axis, -1);
  }
}

// One encoder, and all of them at once.
TEST_F(PlaceScatterTest, SaysNothingOfEncoders) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(seed);
    Place(seed);
    VectorXd all = Noise(seed, 1.0);
    for (int encoder = 0; encoder < 3; ++encoder) {
      const RowVectorXd angles = 10e-6 * Scatter(seed, 4 + encoder);
      const VectorXd left = Left(seed, simulation::kEncoderStage + encoder, angles);
      EXPECT_EQ(Find(left).axis, -1) << encoder;
      all += left - Noise(seed, 1.0);
    }
    EXPECT_EQ(Find(all).axis, -1);
  }
}

// A ball that is not seated, or a machine that comes back less well than stated.
TEST_F(PlaceScatterTest, SaysNothingOfWhatGoesInAllDirections) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(seed);
    Place(seed);
    VectorXd all = Noise(seed, 1.0);
    for (int axis = 0; axis < 3; ++axis) {
      const RowVectorXd moved = 1e-6 * Scatter(seed, 4 + axis);
      all += Left(seed, simulation::MotionStage(axis, axis), moved) - Noise(seed, 1.0);
    }
    EXPECT_EQ(Find(all).axis, -1);
  }
}

// Two of 125 poses, 60 deviations off along an axis.
TEST_F(PlaceScatterTest, SaysNothingOfOutliers) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    Place(seed);
    RowVectorXd moved = RowVectorXd::Zero(places_.cols());
    moved[17] = 60.0 * kNoise;
    moved[80] = -60.0 * kNoise;
    const int axis = static_cast<int>(seed % 3);
    EXPECT_EQ(Find(Left(seed, simulation::MotionStage(axis, axis), moved)).axis, -1);
  }
}

TEST_F(PlaceScatterTest, AWaveWidensItsErrorFromTheReferenceOn) {
  SeenErrors seen;
  seen.functions.resize(21);
  seen.covariance = MatrixXd::Zero(model_.ParameterCount(), model_.ParameterCount());
  CountScatter({{}, {.axis = 2, .sd = 1e-6}, {.axis = 2, .sd = 3e-6}}, model_, seen);
  // The difference of two unrelated places, rms over the travel.
  const Index of_Z = 2 * machine::kMotions + 2;
  EXPECT_NEAR(seen.functions[of_Z].u, 3e-6 * std::numbers::sqrt2, 1e-12);
  double squares = 0.0;
  for (int i = 0; i <= 60; ++i) {
    const Vector3d at(0.0, 0.0, kTravel * i / 60);
    const Eigen::Matrix3Xd J = model_.Linearize(at, -machine_.reference).J_error_parameters;
    const Eigen::Matrix3d covariance = J * seen.covariance * J.transpose();
    EXPECT_EQ(covariance(0, 0), 0.0);
    EXPECT_EQ(covariance(1, 1), 0.0);
    squares += covariance(2, 2) / 61;
  }
  EXPECT_NEAR(std::sqrt(squares), 3e-6 * std::numbers::sqrt2, 0.05e-6);
}

}  // namespace place_scatter_test
}  // namespace abbe::fusion
