// A disturbance that does what a parameter does must answer with the parameter's own derivative.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "rig/record_ballbar.h"
#include "rig/record_plate.h"
#include "simulation/ballbar/ballbar_simulation.h"
#include "simulation/kinds.h"
#include "simulation/linkage/linkage_on_machine.h"
#include "simulation/linkage/linkage_trace.h"
#include "simulation/points/length_simulation.h"
#include "simulation/points/plate_simulation.h"
#include "simulation/points/reference_noise.h"
#include "simulation/points/reference_simulation.h"
#include "simulation/points/reference_trace.h"
#include "simulation/trace.h"
#include "tests/fusion/rig_campaign.h"

namespace abbe::simulation {
namespace response_test {

using Eigen::Index;
using Eigen::VectorXd;

// The derivative of a run by the parameter of this name, at x.
VectorXd ByParameter(const SimulatedRun& run, const VectorXd& x, const std::string& name) {
  VectorXd values(run.residual->Rows());
  estimation::RowMatrix J(values.size(), x.size());
  run.residual->Evaluate(x, values, &J);
  Index column = 0;
  for (const auto& block : run.blocks) {
    for (std::size_t i = 0; i < block.entries.size(); ++i, ++column) {
      if (block.FullName(i) == name) return J.col(column);
    }
  }
  throw std::runtime_error("no parameter " + name);
}

VectorXd StartOf(const SimulatedRun& run) {
  std::vector<double> x;
  for (const auto& block : run.blocks) {
    for (const auto& entry : block.entries) x.push_back(entry.value);
  }
  return Eigen::Map<VectorXd>(x.data(), static_cast<Index>(x.size()));
}

void ExpectSame(const VectorXd& one, const VectorXd& other) {
  ASSERT_EQ(one.size(), other.size());
  ASSERT_GT(other.norm(), 0.0);
  EXPECT_LT((one - other).norm(), 1e-9 * other.norm());
}

// Columns and their adjoint, against rows that mean nothing.
void ExpectAdjoint(const simulation::Response& response, const Disturbance& disturbance,
                   Index rows) {
  VectorXd left(rows);
  for (Index i = 0; i < rows; ++i) left[i] = std::sin(0.7 * static_cast<double>(i + 1));
  const Eigen::MatrixXd back = response.BackToReadings(left);
  double sum = 0.0;
  for (const auto& [stage, values] : disturbance.stages()) {
    sum += (values * response.BackToStage(stage, back)).value();
  }
  const VectorXd column = response.Columns({disturbance}).col(0);
  EXPECT_NEAR(sum, column.dot(left), 1e-12 * column.norm() * left.norm());
}

class Response : public testing::Test {
 protected:
  const settings::Document document = fusion::CampaignMachine();
  const fusion::Campaign campaign{document, 3};

  // How many error motions act; what each does by one coefficient is what that parameter does,
  // beside what the first parameters do, which are free.
  int MotionsThatAct(const SimulatedRun& run, const Trace& trace, const VectorXd& x,
                     Index free = 0) const {
    VectorXd values(run.residual->Rows());
    estimation::RowMatrix J(values.size(), x.size());
    run.residual->Evaluate(x, values, &J);
    const Eigen::HouseholderQR<Eigen::MatrixXd> first(J.leftCols(free));
    const auto beside = [&](VectorXd column) -> VectorXd {
      if (free == 0) return column;
      column.applyOnTheLeft(first.householderQ().transpose());
      column.head(free).setZero();
      return column;
    };
    int acting = 0;
    for (int axis = 0; axis < machine::kAxes; ++axis) {
      for (int motion = 0; motion < machine::kMotions; ++motion) {
        const auto& function = campaign.model.Function(axis, motion);
        VectorXd gradient(function.size());
        Disturbance moved = NoDisturbance(trace);
        for (Index row = 0; row < trace.rows(); ++row) {
          function.Evaluate(trace.axes(axis, row), nullptr, gradient.data());
          moved.row(MotionStage(axis, motion))[row] = gradient[4];
        }
        const VectorXd whole = run.response->At(x)->Columns({moved}).col(0);
        const VectorXd column = beside(whole);
        const double rounding = 1e-12 + 1e-11 * whole.norm();
        const std::string name = machine::MotionName(axis, motion) + ".c4";
        const VectorXd by_parameter = beside(ByParameter(run, x, name));
        EXPECT_LT((column + by_parameter).norm(), 1e-9 * column.norm() + rounding);
        if (column.norm() > rounding) ++acting;
      }
    }
    return acting;
  }
};

TEST_F(Response, OfASweepToItsOwnMotionsIsThatOfTheCoefficients) {
  auto recording = rig::RecordSweep(campaign.rig.world(), 'X', campaign.channels,
                                    {.rate = 50.0, .moving = false});
  const SweepRun sweep = ReadSweepDwells(recording, campaign.instrument.head, campaign.noise);
  const SimulatedRun run =
      SimulateSweep(campaign.model, campaign.reference, campaign.instrument, sweep);
  // Aligned as meant, the probes would not see the axis go along at all.
  const VectorXd x = StartOf(run).array() + 1e-5;
  for (int motion = 0; motion < machine::kMotions; ++motion) {
    const auto& function = campaign.model.Function(0, motion);
    VectorXd gradient(function.size());
    Disturbance moved(sweep.rows());
    for (Index row = 0; row < sweep.rows(); ++row) {
      // At the end of the travel a scale trembles beyond it.
      function.Evaluate(std::clamp(sweep.position[row], 0.0, 60e-3), nullptr, gradient.data());
      moved.row(MotionStage(0, motion))[row] = gradient[4];
    }
    const std::string name = machine::MotionName(0, motion) + ".c4";
    ExpectSame(run.response->At(x)->Columns({moved}).col(0), -ByParameter(run, x, name));
  }
}

TEST_F(Response, OfASweepToTheHeadRisingIsThatOfTheTopProbesAlone) {
  auto recording = rig::RecordSweep(campaign.rig.world(), 'X', campaign.channels,
                                    {.rate = 50.0, .moving = false});
  recording.name = "s";
  const SweepRun sweep = ReadSweepDwells(recording, campaign.instrument.head, campaign.noise);
  const SimulatedRun run =
      SimulateSweep(campaign.model, campaign.reference, campaign.instrument, sweep);
  const VectorXd x = StartOf(run);
  Disturbance risen(sweep.rows());
  risen.row(MotionStage(2, 2)).setOnes();
  const VectorXd top = ByParameter(run, x, "probe_zero s.a") +
                       ByParameter(run, x, "probe_zero s.b") +
                       ByParameter(run, x, "probe_zero s.c");
  ExpectSame(run.response->At(x)->Columns({risen}).col(0), -top);
  Disturbance shown(sweep.rows());
  shown.row(kReadingStage + 3).setOnes();
  ExpectSame(run.response->At(x)->Columns({shown}).col(0), -ByParameter(run, x, "probe_zero s.d"));
  shown.row(MotionStage(0, 4)).setConstant(1e-3);
  ExpectAdjoint(*run.response->At(x), shown, run.residual->Rows());
}

TEST_F(Response, OfLengthsIsThatOfItsParameters) {
  recording::Recording recording;
  recording.name = "lengths";
  recording.header = "kind = \"length\"\ntool_mm = [10.0, 20.0, -50.0]\n";
  recording.columns = {
      {"x_mm", {5.0, 15.0, 30.0, 10.0, 20.0}},     {"y_mm", {10.0, 10.0, 10.0, 20.0, 35.0}},
      {"z_mm", {20.0, 20.0, 20.0, 5.0, 15.0}},     {"pass", {1.0, 1.0, 1.0, 2.0, 2.0}},
      {"length_mm", {0.0, 10.0, 25.0, 0.0, 20.6}}, {"u_length_um", {0.1, 0.1, 0.2, 0.1, 0.1}}};
  const SimulatedRun run = SimulateLengths(campaign.model, campaign.reference, recording);
  const Trace trace = TraceOf(recording, ReadMachinePoints(recording));
  const VectorXd x = StartOf(run).array() + 1e-5;
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      const auto& function = campaign.model.Function(axis, motion);
      VectorXd gradient(function.size());
      Index bent = 0;
      function.Evaluate(trace.axes(axis, 2), nullptr, gradient.data());
      gradient.maxCoeff(&bent);
      Disturbance moved = NoDisturbance(trace);
      for (Index row = 0; row < trace.rows(); ++row) {
        function.Evaluate(trace.axes(axis, row), nullptr, gradient.data());
        moved.row(MotionStage(axis, motion))[row] = gradient[bent];
      }
      const std::string name = fmt::format("{}.c{}", machine::MotionName(axis, motion), bent);
      ExpectSame(run.response->At(x)->Columns({moved}).col(0), -ByParameter(run, x, name));
    }
  }
  Disturbance second = NoDisturbance(trace);
  second.row(MotionStage(0, 0))[2] = 1.0;
  ExpectAdjoint(*run.response->At(x), second, run.residual->Rows());
  const double weight = run.response->At(x)->WeightsOf(MotionStage(0, 0))[2];
  EXPECT_GE(weight, run.response->At(x)->Columns({second}).squaredNorm());
}

// A scale may show some micrometres beyond the end of its travel: a length is that of the places.
TEST_F(Response, OfLengthsDoesNotHangOnTheEndOfTheTravel) {
  const auto off_at = [&](double shift_mm) {
    recording::Recording recording;
    recording.name = "lengths";
    recording.header = "kind = \"length\"\ntool_mm = [10.0, 20.0, -50.0]\n";
    recording.columns = {{"x_mm", {shift_mm, 30.0 + shift_mm, 60.0 + shift_mm}},
                         {"y_mm", {10.0, 10.0, 10.0}},
                         {"z_mm", {20.0, 20.0, 20.0}},
                         {"pass", {1.0, 1.0, 1.0}},
                         {"length_mm", {0.0, 30.0, 60.0}},
                         {"u_length_um", {0.1, 0.1, 0.1}}};
    const SimulatedRun run = SimulateLengths(campaign.model, campaign.reference, recording);
    VectorXd values(run.residual->Rows());
    run.residual->Evaluate(VectorXd::Zero(StartOf(run).size()), values, nullptr);
    return values;
  };
  for (const double shift_mm : {-0.003, 0.0, 0.003}) {
    EXPECT_LT(off_at(shift_mm).cwiseAbs().maxCoeff(), 1e-6) << shift_mm;  // of 0.1 um
  }
}

TEST_F(Response, OfAPlateIsThatOfItsParameters) {
  const auto recording = rig::RecordPlate(campaign.rig.world(), {.holes = 3});
  for (const PlateSetup& setup : ReadPlate(recording)) {
    const SimulatedRun run = SimulatePlate(campaign.model, campaign.reference, setup);
    const Trace trace = TraceOf(recording, setup.points);
    const VectorXd x = StartOf(run).array() + 1e-5;
    EXPECT_GE(MotionsThatAct(run, trace, x), 6);
    Disturbance second = NoDisturbance(trace);
    second.row(MotionStage(1, 4))[1] = 1e-3;
    ExpectAdjoint(*run.response->At(x), second, run.residual->Rows());
  }
}

TEST_F(Response, OfAReferenceIsThatOfItsParameters) {
  const auto course = rig::DwellCourse(
      rig::GridPlaces(Eigen::Vector3d::Constant(0.03), {0.05, 0.05, 0.05}, {3, 2, 2}), 0.1, 0.1, 1);
  const auto recording = campaign.rig.Record(
      course, {.kind = "reference", .rate = 20.0, .keys = "tool_mm = [10.0, 20.0, -50.0]\n"});
  ReferenceRun places = MeansOfStays(ReadReferenceRun(recording));
  SetNoise({1e-7, 2e-7, 3e-7}, places);
  const SimulatedRun run = SimulateReference(campaign.model, campaign.reference, places);
  const Trace trace = TraceOf(recording, places);
  ASSERT_EQ(trace.rows(), 12);
  const VectorXd x = StartOf(run).array() + 1e-5;
  EXPECT_EQ(MotionsThatAct(run, trace, x), machine::kAxes * machine::kMotions);
  Disturbance second = NoDisturbance(trace);
  second.row(MotionStage(1, 1))[1] = 1.0;
  ExpectAdjoint(*run.response->At(x), second, run.residual->Rows());
  const double weight = run.response->At(x)->WeightsOf(MotionStage(1, 1))[1];
  EXPECT_NEAR(weight, run.response->At(x)->Columns({second}).squaredNorm(), 1e-9 * weight);
}

TEST_F(Response, OfABallbarIsThatOfItsParameters) {
  const Eigen::Vector3d centre = Eigen::Vector3d::Constant(0.03);
  const auto course = rig::CircleCourse({'Z', centre, 0.025, 0.01, 1});
  const auto recording =
      rig::RecordBallbar(campaign.rig, course, {.plane = "XY", .centre = centre, .radius = 0.025},
                         {.rate = 5.0, .keys = "tool_mm = [10.0, 20.0, -50.0]\n"});
  const BallbarRun circle = ReadBallbarRun(recording);
  const SimulatedRun run = SimulateBallbar(campaign.model, campaign.reference, circle);
  const Trace trace = BallbarKind()
                          .Prepare(recording, campaign.model,
                                   {campaign.machine, campaign.instrument.head,
                                    campaign.instrument.target, campaign.noise, campaign.linkage},
                                   {})
                          .runs[0]
                          .trace;
  ASSERT_EQ(trace.rows(), circle.rows());
  const VectorXd x = StartOf(run).array() + 1e-5;
  // The centre is where the machine stood when it was set up: that much is free.
  EXPECT_GE(MotionsThatAct(run, trace, x, 3), 12);
  Disturbance second = NoDisturbance(trace);
  second.row(MotionStage(1, 1))[1] = 1.0;
  ExpectAdjoint(*run.response->At(x), second, run.residual->Rows());
  const double weight = run.response->At(x)->WeightsOf(MotionStage(1, 1))[1];
  EXPECT_NEAR(weight, run.response->At(x)->Columns({second}).squaredNorm(), 1e-9 * weight);
}

TEST_F(Response, OfALinkageIsThatOfItsParameters) {
  const LinkageSimulation nominal(
      campaign.machine.chain, campaign.linkage,
      relm::MakeLinkageModel(campaign.linkage, relm::ErrorModel::kComplete));
  const auto recording = campaign.LinkageRecording(3);
  const LinkageRun poses = MeansOfStays(ReadLinkageRun(recording, campaign.linkage));
  const SimulatedRun run = SimulateLinkage(campaign.model, campaign.reference, nominal, poses);
  const Trace trace = TraceOf(recording, poses, nominal);
  const VectorXd x = StartOf(run);
  for (int pivot = 0; pivot < 3; ++pivot) {
    const std::string name = "pivot_" + std::to_string(pivot + 1);
    Disturbance shown = NoDisturbance(trace);
    shown.row(kEncoderStage + pivot).setOnes();
    ExpectSame(run.response->At(x)->Columns({shown}).col(0),
               ByParameter(run, x, "encoder_offset." + name));
  }
  // The tip moved as the ball's offset along the last link moves it.
  Disturbance longer = NoDisturbance(trace);
  for (int k = 0; k < 3; ++k) longer.row(kTipStage + k) = trace.linkage->link.row(6 + k);
  ExpectSame(run.response->At(x)->Columns({longer}).col(0), -ByParameter(run, x, "ball.along"));
  Disturbance dragged = NoDisturbance(trace);
  dragged.row(kToolStage + 1).setOnes();
  ExpectSame(run.response->At(x)->Columns({dragged}).col(0), ByParameter(run, x, "base.y"));
  dragged.row(kEncoderStage + 1) = trace.time.transpose();
  dragged.row(MotionStage(2, 3)) = trace.axes.row(1);
  ExpectAdjoint(*run.response->At(x), dragged, run.residual->Rows());
}

}  // namespace response_test
}  // namespace abbe::simulation
