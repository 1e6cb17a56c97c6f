#include "rig/record_plate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "random/counter_random.h"
#include "rig/climate.h"
#include "rig/hidden_run.h"
#include "rig/rotation.h"
#include "rig/streams.h"
#include "settings/toml_text.h"
#include "settings/unit.h"

namespace abbe::rig {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

using settings::kMicro;
using settings::kMicrometre;
using settings::kMillimetre;
constexpr double kOffPlace = 0.2e-3, kOffTurn = 1e-3;  // m, rad: errors of placing a plate
constexpr double kDepth = 10e-6;                       // m
constexpr double kShareOfTravel = 0.9;
constexpr int kApproaches = 6;      // iterations, each a thousand times nearer
constexpr double kFromSide = 1e-3;  // m, from where the axes come to a hole

Vector3d Normals(const random::CounterRandom& random, std::uint64_t first) {
  return {random.Normal(first), random.Normal(first + 1), random.Normal(first + 2)};
}

// The place of the tool in the workpiece.
Vector3d ToolAt(const World& world, const Vector3d& position, const Vector3d& tool) {
  const Displacement table = world.PoseOfTarget(position);
  return table.rotation.transpose() * (world.PoseOfHead(position) * tool - table.translation);
}

class PlateMaker {
 public:
  PlateMaker(const World& world, const PlateProgram& program)
      : world_(world),
        program_(program),
        plate_(world.seed(), kPlateStream),
        run_(world.seed(), kPlateRunStream + kRunStreams * program.run),
        climate_(world.settings(), world.seed(), program.run, {}),
        hidden_(world.hidden(), climate_, {}) {
    for (int axis = 0; axis < kAxes; ++axis) {
      const AxisTravel& travel = world.settings().travels[axis];
      middle_[axis] = (travel.first + travel.last) / 2;
      const double side = kShareOfTravel * (travel.last - travel.first);
      side_ = axis == 0 ? side : std::min(side_, side);
      sign_[axis] = world.settings().ToolWay(axis);
    }
  }

  recording::Recording Make() {
    recording_.name = fmt::format("rig plate, seed {}", world_.seed());
    recording_.header = Header();
    for (const char* name :
         {"time_s", "x_mm", "y_mm", "z_mm", "setup", "hole", "plate_x_mm", "plate_y_mm",
          "u_plate_um", "approach_x", "approach_y", "approach_z", "flags"}) {
      recording_.columns.push_back({name, {}});
    }
    for (std::size_t setup = 0; setup < program_.setups.size(); ++setup) Measure(setup);
    return std::move(recording_);
  }

 private:
  std::string Header() const {
    std::string header = fmt::format(
        "kind = \"plate\"\nmachine = {}\nstarted = \"1970-01-01T00:00:00Z\"\nsource = \"rig\"\n"
        "plate = \"rig-{}\"\nu_probing_um = {}\nu_scale_ppm = {}\n\n[rig]\nseed = {}\nrun = {}\n",
        settings::Quoted(world_.settings().name), world_.seed(), program_.u_probing / kMicrometre,
        program_.u_scale / kMicro, world_.seed(), program_.run);
    for (std::size_t i = 0; i < program_.setups.size(); ++i) {
      const Vector3d tool = program_.setups[i].tool / kMillimetre;
      header +=
          fmt::format("\n[setup.{}]\ntool_mm = [{}, {}, {}]\n", i + 1, tool[0], tool[1], tool[2]);
    }
    return header;
  }

  Vector2d Certificate(int hole) const {
    const int n = program_.holes;
    return Vector2d(hole % n, hole / n) * side_ / (n - 1.0);
  }

  // The true place of a hole in the plate.
  Vector2d TruePlace(int hole) const {
    const auto index = 1 + 2 * static_cast<std::uint64_t>(hole);
    const Vector2d form(plate_.Normal(index), plate_.Normal(index + 1));
    return (1.0 + program_.u_scale * plate_.Normal(0)) *
           (Certificate(hole) + program_.u_form * form);
  }

  // The axis positions that put the tool at a place of the workpiece.
  Vector3d AxesAt(const Vector3d& place, const Vector3d& tool) const {
    Vector3d axes = middle_;
    for (int i = 0; i < kApproaches; ++i) {
      axes += sign_.cwiseProduct(place - ToolAt(world_, axes, tool));
    }
    return axes;
  }

  void Measure(std::size_t number) {
    const PlateSetup& setup = program_.setups[number];
    const int holes = program_.holes * program_.holes;
    const std::uint64_t first = number * (3 * holes + 6);
    Matrix3d R;
    R.col(0) = Vector3d::Unit(setup.directions[0]);
    R.col(1) = Vector3d::Unit(setup.directions[1]);
    R.col(2) = R.col(0).cross(R.col(1));
    const Vector3d centre =
        setup.tool + sign_.cwiseProduct(middle_) + kOffPlace * Normals(run_, first);
    R = FullRotation(kOffTurn * Normals(run_, first + 3)) * R;
    for (int hole = 0; hole < holes; ++hole) {
      const Vector3d noise = Normals(run_, first + 6 + 3 * static_cast<std::uint64_t>(hole));
      Vector3d place(-side_ / 2, -side_ / 2, kDepth * noise.z());
      place.head<2>() += TruePlace(hole) + program_.u_probing * noise.head<2>();
      Put(number, hole, AxesAt(centre + R * place, setup.tool));
    }
  }

  // Where the axes show that they stand when they really stand at `axes`, having come from `side`.
  Vector3d ShownAt(const Vector3d& axes, double side) {
    const auto time = static_cast<double>(recording_.rows());
    Vector3d shown = axes;
    hidden_.Follow(time, axes - Vector3d::Constant(side * kFromSide), Vector3d::Zero());
    for (int i = 0; i < kApproaches; ++i) {
      hidden_.Follow(time, shown, Vector3d::Zero());
      shown += axes - hidden_.Place();
    }
    return shown;
  }

  void Put(std::size_t setup, int hole, const Vector3d& place) {
    const double side = program_.both_sides && hole / program_.holes % 2 == 1 ? -1.0 : 1.0;
    const Vector3d axes = ShownAt(place, side);
    const Vector2d certificate = Certificate(hole) / kMillimetre;
    std::size_t column = 0;
    const double row = recording_.rows();
    for (const double value :
         {row, axes[0] / kMillimetre, axes[1] / kMillimetre, axes[2] / kMillimetre,
          static_cast<double>(setup + 1), hole + 1.0, certificate[0], certificate[1],
          program_.u_form / kMicrometre, side, side, side, 0.0}) {
      recording_.columns[column++].values.push_back(value);
    }
  }

  const World& world_;
  const PlateProgram& program_;
  random::CounterRandom plate_, run_;
  Climate climate_;
  HiddenRun hidden_;
  Vector3d middle_ = Vector3d::Zero(), sign_ = Vector3d::Ones();
  double side_ = 0.0;
  recording::Recording recording_;
};

}  // namespace

std::vector<PlateSetup> FiveSetups(double stylus) {
  return {{{0, 1}, {0.0, 0.0, -stylus}},
          {{0, 2}, {0.0, stylus, 0.0}},
          {{0, 2}, {0.0, -stylus, 0.0}},
          {{1, 2}, {stylus, 0.0, 0.0}},
          {{1, 2}, {-stylus, 0.0, 0.0}}};
}

recording::Recording RecordPlate(const World& world, const PlateProgram& program) {
  return PlateMaker(world, program).Make();
}

}  // namespace abbe::rig
