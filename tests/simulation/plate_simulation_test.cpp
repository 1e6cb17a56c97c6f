// The plate simulation against the closed forms of Ha and Khanh: a moving bridge whose error at
// each hole is theirs.
#include "simulation/points/plate_simulation.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "failure/failure.h"
#include "geometry/rotation.h"
#include "machine/configurations.h"
#include "random/counter_random.h"
#include "tests/machine/published_volumetric_errors.h"

namespace abbe::simulation {
namespace plate_simulation_test {

using Eigen::Index;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using geometry::Transform;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kTravel = 0.4;

machine::VolumetricModel Bridge(std::uint64_t seed) {
  machine::VolumetricModel model(machine::ChainOf("moving-bridge"),
                                 {{{0.0, kTravel}, {0.0, kTravel}, {0.0, kTravel}}});
  const auto form = machine::MakePolynomialForm(4, 0.0, kTravel);
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    for (int motion = 0; motion < machine::kMotions; ++motion) model.SetForm(axis, motion, form);
  }
  const random::CounterRandom random(seed, 5);
  VectorXd parameters(model.ParameterCount());
  for (Index i = 0; i < parameters.size(); ++i) {
    parameters[i] = 5e-6 * random.Normal(static_cast<std::uint64_t>(i));
  }
  model.SetParameters(parameters);
  return model;
}

// Equations 19 to 21 with the term that 19 lacks; xwy turns the X line, ISO the Y line: a turn of
// the table.
Vector3d PaperError(const machine::VolumetricModel& model, const Vector3d& q, const Vector3d& p) {
  const auto errors = model.Motions(q);
  const auto& [x, y, z] = errors.axes;
  const Vector3d square = errors.squareness;
  const machine::BridgeErrors paper{{-x[0], x[1], x[2]}, {y[0], -y[1], y[2]}, {z[0], z[1], -z[2]},
                                    {x[3], x[4], x[5]},  {y[3], y[4], y[5]},  {z[3], z[4], z[5]},
                                    square.z(),          -square.y(),         square.x()};
  return machine::HaKhanhAsPrinted(paper, q.x(), q.z(), p.x(), p.y(), p.z()) +
         Vector3d(paper.zr[1] * p.z(), 0, 0) +
         Vector3d(0, 0, square.z()).cross(Vector3d(q.x(), q.y(), 0));
}

struct Written {
  recording::Recording recording;
  Transform<double> X_MP;
};

// A plate of 5 x 5 holes in the plane of two axes, turned by 20 mrad about its normal.
Written PlateOn(const machine::VolumetricModel& model, int first, int second,
                const Vector3d& tool) {
  Written written;
  auto& [recording, X_MP] = written;
  recording.name = "plate.csv";
  recording.header =
      fmt::format("kind = \"plate\"\nu_probing_um = 1.0\n[setup.4]\ntool_mm = [{}, {}, {}]\n",
                  1e3 * tool.x(), 1e3 * tool.y(), 1e3 * tool.z());
  for (const char* name : {"x_mm", "y_mm", "z_mm", "setup", "hole", "plate_x_mm", "plate_y_mm"}) {
    recording.columns.push_back({name, {}});
  }
  X_MP.R.col(0) = Vector3d::Unit(first);
  X_MP.R.col(1) = Vector3d::Unit(second);
  X_MP.R.col(2) = X_MP.R.col(0).cross(X_MP.R.col(1));
  X_MP.R = geometry::ExpRotation<double>(0.02 * X_MP.R.col(2)) * X_MP.R;
  X_MP.p = tool + Vector3d::Constant(0.05);
  for (int hole = 0; hole < 25; ++hole) {
    const Vector3d place(0.06 * (hole % 5), 0.06 * (hole / 5), 0.0);
    Vector3d q = X_MP * place - tool;
    for (int i = 0; i < 4; ++i) q = X_MP * place - tool - PaperError(model, q, tool);
    std::size_t column = 0;
    for (const double value : {1e3 * q.x(), 1e3 * q.y(), 1e3 * q.z(), 4.0, hole + 1.0,
                               1e3 * place.x(), 1e3 * place.y()}) {
      recording.columns[column++].values.push_back(value);
    }
  }
  return written;
}

TEST(PlateSimulation, ReadsWhatTheClosedFormsOfHaAndKhanhSay) {
  for (std::uint64_t seed = 1; seed < 6; ++seed) {
    const machine::VolumetricModel model = Bridge(seed);
    for (const auto& [first, second] : {std::pair{0, 1}, {0, 2}, {1, 2}}) {
      const Written written = PlateOn(model, first, second, {0.02, -0.03, -0.1});
      const PlateSetup setup = ReadPlate(written.recording).at(0);
      const SimulatedRun run = SimulatePlate(model, Vector3d::Zero(), setup);
      // How the plate really lies, from where the simulation starts.
      const PointsOnMachine points(model, Vector3d::Zero(), setup.points);
      const Transform<double> off = PlatePose(points, setup).Inverse() * written.X_MP;
      VectorXd x(model.ParameterCount() + 3), values(run.residual->Rows());
      x << model.Parameters(), off.p.head<2>(), std::atan2(off.R(1, 0), off.R(0, 0));
      run.residual->Evaluate(x, values, nullptr);
      // A few products of two errors of 30 urad, over 0.5 m: 0.5 nm each; in u_probing of 1 um.
      EXPECT_LT(values.cwiseAbs().maxCoeff(), 3e-3) << seed;
      x.head(model.ParameterCount()).setZero();
      run.residual->Evaluate(x, values, nullptr);
      EXPECT_GT(values.cwiseAbs().maxCoeff(), 3.0);  // the machine has errors of micrometres
    }
  }
}

class BadPlate : public testing::Test {
 protected:
  recording::Recording plate_ = PlateOn(Bridge(1), 0, 1, {0.0, 0.0, -0.1}).recording;

  std::vector<double>& Column(const std::string& name) {
    for (auto& column : plate_.columns) {
      if (column.name == name) return column.values;
    }
    throw InputError(name);
  }
  void Refuses(const std::string& saying) {
    EXPECT_THAT(
        [&] {
          for (const auto& setup : ReadPlate(plate_)) {
            SimulatePlate(Bridge(1), Vector3d::Zero(), setup);
          }
        },
        ThrowsMessage<InputError>(HasSubstr(saying)));
  }
};

TEST_F(BadPlate, OfAHoleInTwoPlaces) {
  Column("hole")[7] = 3;
  Refuses(
      "plate.csv: row 8: hole 3 is at 120.0000, 60.0000 mm here and at 120.0000, 0.0000 mm in "
      "row 3");
}

TEST_F(BadPlate, OfAnUnknownSetup) {
  Column("setup")[24] = 6;
  Refuses("plate.csv: row 25: the header knows no set-up 6; add [setup.6]");
}

TEST_F(BadPlate, OfAWrongPosition) {
  Column("x_mm")[12] += 5.0;
  Refuses("plate.csv set-up 4: row 13: hole 13 is");
}

TEST_F(BadPlate, OfHolesInALine) {
  for (auto& column : plate_.columns) column.values.resize(5);
  Refuses("set-up 4: 5 holes do not say how the plate lay");
}

TEST_F(BadPlate, WithoutUncertainty) {
  plate_.header = "kind = \"plate\"\n";
  Refuses("header: state u_probing_um");
}

}  // namespace plate_simulation_test
}  // namespace abbe::simulation
