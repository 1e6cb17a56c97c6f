#include "simulation/points/plate_simulation.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "failure/failure.h"
#include "recording/made_on.h"
#include "simulation/stage_response.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kNotThisHole = 1e-3;  // m: no machine is as wrong as that
constexpr double kSpan = 1e-3;         // m: rms width below which holes stand in a line
constexpr Index kPose = 3;             // u, v, turn

struct Hole {
  std::size_t row;
  Vector2d place;
};

InputError Bad(const MachinePoints& points, Index i, const std::string& what) {
  return InputError(fmt::format("{}: row {}: {}", points.name, points.rows[i] + 1, what));
}

void RefuseTwoPlaces(const MachinePoints& points, const std::vector<int>& holes,
                     const Eigen::Matrix2Xd& certificate) {
  std::map<int, Hole> known;
  for (Index i = 0; i < points.count(); ++i) {
    const auto row = points.rows[i];
    const int number = holes[i];
    const Hole& first = known.try_emplace(number, Hole{row, certificate.col(i)}).first->second;
    if (first.place == certificate.col(i)) continue;
    throw Bad(points, i,
              fmt::format("hole {} is at {:.4f}, {:.4f} mm here and at {:.4f}, {:.4f} mm in row "
                          "{}; correct plate_x_mm, plate_y_mm or the number of the hole",
                          number, 1e3 * certificate(0, i), 1e3 * certificate(1, i),
                          1e3 * first.place.x(), 1e3 * first.place.y(), first.row + 1));
  }
}

double Probing(const recording::Recording& recording) {
  const double u = 1e-6 * recording.HeaderNumber("u_probing_um", 0.0).value_or(0.0);
  if (u > 0.0) return u;
  throw InputError(
      fmt::format("{}: header: state u_probing_um above 0, the standard uncertainty of a hole "
                  "centre in each direction",
                  recording.name));
}

Vector3d ToolOf(const recording::Recording& recording, int setup, std::size_t row) {
  if (const auto own = HeaderPoint(recording, fmt::format("setup.{}.tool_mm", setup))) return *own;
  if (!recording.HeaderText("setup")) {
    return HeaderPoint(recording, "tool_mm").value_or(Vector3d::Zero());
  }
  throw InputError(
      fmt::format("{}: row {}: the header knows no set-up {}; add [setup.{}] with its tool_mm, or "
                  "correct the column setup",
                  recording.name, row + 1, setup, setup));
}

void RefuseLine(const PlateSetup& setup) {
  const Eigen::Matrix2Xd centred =
      setup.certificate.colwise() - setup.certificate.rowwise().mean().eval();
  const Matrix2d spread = centred * centred.transpose() / centred.cols();
  if (Eigen::SelfAdjointEigenSolver<Matrix2d>(spread).eigenvalues()[0] > kSpan * kSpan) return;
  throw InputError(
      fmt::format("{}: {} holes do not say how the plate lay; measure three or more that do not "
                  "stand in a line",
                  setup.points.name, setup.points.count()));
}

estimation::ParameterBlock FormOf(const PlateSetup& setup, std::size_t point) {
  const double u = setup.u_form[point];
  estimation::ParameterBlock block(HoleBlock(setup, setup.holes[point]), {"um", 1e-6}, {});
  for (const char* direction : {"u", "v"}) {
    block.entries.push_back({.name = direction, .prior_sd = u > 0.0 ? u : estimation::kNoPrior});
    block.entries.back().held = !(u > 0.0);
  }
  return block;
}

// x: machine, u, v, turn, scale where it is free, then the form of each hole where it is free.
class PlateResidual : public Responsive {
 public:
  PlateResidual(PointsOnMachine points, PlateSetup setup, std::vector<Index> form)
      : points_(std::move(points)),
        setup_(std::move(setup)),
        form_(std::move(form)),
        scaled_(setup_.u_scale > 0.0),
        X_PM_(PlatePose(points_, setup_).Inverse()) {}

  Index Rows() const override { return 2 * points_.points().count(); }

  void Evaluate(const VectorXd& x, VectorXd& values,
                estimation::RowMatrix* jacobian) const override {
    const Index machine = points_.parameters(), first_form = machine + kPose + (scaled_ ? 1 : 0);
    std::vector<Matrix3Xd> J;
    const Matrix3Xd p = points_.Places(x.head(machine), jacobian == nullptr ? nullptr : &J);
    const double scale = scaled_ ? 1.0 + x[machine + kPose] : 1.0;
    const Matrix2d back = Eigen::Rotation2Dd(-x[machine + 2]).toRotationMatrix();
    if (jacobian != nullptr) jacobian->setZero();
    for (Index i = 0; i < p.cols(); ++i) {
      const Vector2d off = (X_PM_ * Vector3d(p.col(i))).head<2>() - x.segment<2>(machine);
      const Index form = form_.empty() ? -1 : first_form + 2 * form_[i];
      Vector2d place = setup_.certificate.col(i);
      if (form >= 0) place += x.segment<2>(form);
      values.segment<2>(2 * i) = (back * off - scale * place) / setup_.u_probing;
      if (jacobian == nullptr) continue;
      auto out = jacobian->middleRows<2>(2 * i);
      out.leftCols(machine) = back * X_PM_.R.topRows<2>() * J[i];
      out.middleCols<2>(machine) = -back;
      out.col(machine + 2) = back * Vector2d(off.y(), -off.x());
      if (scaled_) out.col(machine + kPose) = -place;
      if (form >= 0) out.middleCols<2>(form) = -scale * Matrix2d::Identity();
      out /= setup_.u_probing;
    }
  }

  std::shared_ptr<const Response> At(const VectorXd& x) const override {
    const Index machine = points_.parameters();
    const MatrixXd by_motions = points_.ByMotions(x.head(machine));
    const Matrix2d back = Eigen::Rotation2Dd(-x[machine + 2]).toRotationMatrix();
    MatrixXd by_stage(Rows(), by_motions.cols());
    for (Index i = 0; i < points_.points().count(); ++i) {
      by_stage.middleRows<2>(2 * i) =
          -back * X_PM_.R.topRows<2>() * by_motions.middleRows<3>(3 * i) / setup_.u_probing;
    }
    return std::make_shared<StageResponse>(std::move(by_stage), 2);
  }

 private:
  PointsOnMachine points_;
  PlateSetup setup_;
  std::vector<Index> form_;  // of each point: which of the free holes it is
  bool scaled_;
  geometry::Transform<double> X_PM_;
};

}  // namespace

PlateSetup PartOf(const PlateSetup& all, const std::vector<Index>& of) {
  PlateSetup part = all;
  const Index n = of.size();
  part.points.axes = all.points.axes(Eigen::all, of);
  part.certificate = all.certificate(Eigen::all, of);
  part.u_form = all.u_form(of);
  part.holes.resize(of.size());
  part.points.rows.resize(of.size());
  for (Index i = 0; i < n; ++i) {
    const std::size_t from = of[i];
    part.holes[i] = all.holes[from];
    part.points.rows[i] = all.points.rows[from];
  }
  return part;
}

std::string HoleBlock(const PlateSetup& setup, int hole) {
  return fmt::format("plate_hole {} {}", setup.plate, hole);
}

std::vector<PlateSetup> ReadPlate(const recording::Recording& recording) {
  recording::RefuseOtherKind(recording, "plate", "abbe fuse takes it together with plates");
  PlateSetup all;
  all.points = ReadMachinePoints(recording);
  all.plate = recording.HeaderText("plate").value_or(recording.name);
  all.u_probing = Probing(recording);
  all.u_scale = 1e-6 * recording.HeaderNumber("u_scale_ppm", 0.0).value_or(0.0);
  const VectorXd setup = ColumnAt(recording, all.points, "setup");
  const VectorXd hole = ColumnAt(recording, all.points, "hole");
  all.certificate.resize(2, setup.size());
  all.certificate.row(0) = ColumnAt(recording, all.points, "plate_x_mm");
  all.certificate.row(1) = ColumnAt(recording, all.points, "plate_y_mm");
  all.u_form = recording.Find("u_plate_um") ? ColumnAt(recording, all.points, "u_plate_um")
                                            : VectorXd::Zero(setup.size());
  for (const double number : hole) all.holes.push_back(static_cast<int>(number));
  RefuseTwoPlaces(all.points, all.holes, all.certificate);

  std::vector<int> order;
  std::map<int, std::vector<Index>> rows;
  for (Index i = 0; i < setup.size(); ++i) {
    const int number = static_cast<int>(setup[i]);
    if (!rows.contains(number)) order.push_back(number);
    rows[number].push_back(i);
  }
  std::vector<PlateSetup> setups;
  for (const int number : order) {
    PlateSetup& part = setups.emplace_back(PartOf(all, rows[number]));
    part.points.tool = ToolOf(recording, number, part.points.rows.front());
    part.points.name = fmt::format("{} set-up {}", recording.name, number);
    RefuseLine(part);
  }
  return setups;
}

geometry::Transform<double> PlatePose(const PointsOnMachine& points, const PlateSetup& setup) {
  const Matrix3Xd places = points.Places(VectorXd::Zero(points.parameters()));
  Matrix3Xd plate = Matrix3Xd::Zero(3, places.cols());
  plate.topRows<2>() = setup.certificate;
  const Eigen::Matrix4d X = Eigen::umeyama(plate, places, false);
  const geometry::Transform<double> X_MP{X.topLeftCorner<3, 3>(), X.topRightCorner<3, 1>()};
  Index worst = 0;
  const double off =
      (places - ((X_MP.R * plate).colwise() + X_MP.p)).colwise().norm().maxCoeff(&worst);
  if (off > kNotThisHole) {
    throw Bad(
        points.points(), worst,
        fmt::format("hole {} is {:.1f} mm from where the plate has it; correct the numbers of "
                    "holes and set-ups, the certificate or the positions",
                    setup.holes[worst], 1e3 * off));
  }
  return X_MP;
}

SimulatedRun SimulatePlate(const machine::VolumetricModel& model, const Vector3d& reference,
                           const PlateSetup& setup) {
  SimulatedRun simulated{setup.points.name, "plate", model.Blocks(), nullptr,
                         estimation::RobustLoss::None()};
  auto& blocks = simulated.blocks;
  blocks.push_back({"plate_place " + setup.points.name, {"um", 1e-6}, {{"u"}, {"v"}}});
  blocks.push_back({"plate_turn " + setup.points.name, {"urad", 1e-6}, {{"w"}}});
  if (setup.u_scale > 0.0) {
    blocks.push_back({"plate_scale " + setup.plate,
                      {"ppm", 1e-6},
                      {{.name = "scale", .prior_sd = setup.u_scale}}});
  }
  std::vector<Index> form;
  if (setup.u_form.maxCoeff() > 0.0) {
    std::map<int, Index> known;
    for (std::size_t i = 0; i < setup.holes.size(); ++i) {
      const Index next = known.size();
      const auto [at, is_new] = known.try_emplace(setup.holes[i], next);
      if (is_new) blocks.push_back(FormOf(setup, i));
      form.push_back(at->second);
    }
  }
  const auto residual = std::make_shared<PlateResidual>(
      PointsOnMachine(model, reference, setup.points), setup, std::move(form));
  simulated.residual = simulated.response = residual;
  return simulated;
}

}  // namespace abbe::simulation
