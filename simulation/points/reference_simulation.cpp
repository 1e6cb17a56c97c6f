#include "simulation/points/reference_simulation.h"

#include <fmt/format.h>

#include <array>
#include <utility>
#include <vector>

#include "failure/failure.h"
#include "geometry/rotation.h"
#include "simulation/points/machine_points.h"
#include "simulation/points/reference_noise.h"
#include "simulation/stage_response.h"
#include "simulation/trace_columns.h"
#include "simulation/trace_motion.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kAlignment = 10e-3;  // rad: how well an instrument is aligned by hand

std::vector<Index> AxesShown(const ReferenceRun& run) {
  std::vector<Index> shown;
  for (Index axis = 0; axis < 3; ++axis) {
    if (run.shown[axis]) shown.push_back(axis);
  }
  return shown;
}

// A line along the direction that a laser shows: a turn of it acts by its cosine alone, which the
// data could not tell from a scale, nor one side from the other. Lasers that return their beam over
// a line are aligned to fractions of a milliradian, below 0.1 ppm.
bool IsLineOfSight(const ReferenceRun& run) {
  constexpr double kOneLine = 1e-3;  // m
  const std::vector<Index> shown = AxesShown(run);
  if (shown.size() != 1) return false;
  for (Index axis = 0; axis < 3; ++axis) {
    const auto across = run.points.axes.row(axis);
    if (axis != shown.front() && across.maxCoeff() - across.minCoeff() > kOneLine) return false;
  }
  return true;
}

// In M, from axis coordinates.
Matrix3Xd PlacesInMachine(const machine::Chain& chain, const ReferenceRun& run) {
  return chain.ToolSenses().asDiagonal() * run.place;
}

class PlaceResponse : public StageResponse {
 public:
  PlaceResponse(MatrixXd by_stage, MatrixXd places, MatrixXd sd)
      : StageResponse(std::move(by_stage), places.rows()),
        places_(std::move(places)),
        sd_(std::move(sd)) {}

  // Places in M, of the directions that the instrument shows.
  MatrixXd Readings(const VectorXd& left) const override {
    return places_ - left.reshaped(places_.rows(), places_.cols()).cwiseProduct(sd_);
  }

 private:
  MatrixXd places_, sd_;
};

// x: place, turn, machine, and the scale where the header states how well it is known. Rows: the directions shown of the first point, of the next, ...
class ReferenceResidual : public Responsive {
 public:
  ReferenceResidual(const machine::VolumetricModel& model, const Vector3d& reference,
                    const ReferenceRun& run)
      : points_(model, reference, run.points),
        shown_(AxesShown(run)),
        place_(PlacesInMachine(model.chain(), run)),
        sd_(run.sd),
        scaled_(run.u_scale > 0.0) {}

  Index Rows() const override { return shown_.size() * points_.points().count(); }

  void Evaluate(const VectorXd& x, VectorXd& values,
                estimation::RowMatrix* jacobian) const override {
    std::vector<Matrix3Xd> J;
    const Matrix3Xd p = points_.Places(Machine(x), jacobian == nullptr ? nullptr : &J);
    const double scale = scaled_ ? x[kSetup + points_.parameters()] : 0.0;
    const Vector3d turn = x.segment<3>(3);
    const Matrix3d R = geometry::ExpRotation<double>(turn);
    const Matrix3d by_turn = geometry::ExpRotationJacobian(turn);
    Index row = 0;
    for (Index i = 0; i < p.cols(); ++i) {
      const Vector3d turned = R * p.col(i);
      const Vector3d left = place_.col(i) - x.head<3>() - (1.0 + scale) * turned;
      const Matrix3d J_turn = geometry::Skew(turned) * by_turn;
      for (const Index axis : shown_) {
        values[row] = left[axis] / sd_(axis, i);
        if (jacobian != nullptr) {
          auto out = jacobian->row(row);
          out.head<3>() = -Eigen::RowVector3d::Unit(axis);
          out.segment<3>(3) = J_turn.row(axis);
          out.segment(kSetup, points_.parameters()) = -R.row(axis) * J[i];
          if (scaled_) out[kSetup + points_.parameters()] = -turned[axis];
          out /= sd_(axis, i);
        }
        ++row;
      }
    }
  }

  std::shared_ptr<const Response> At(const VectorXd& x) const override {
    const Matrix3d R = geometry::ExpRotation<double>(Vector3d(x.segment<3>(3)));
    const MatrixXd by_motions = points_.ByMotions(Machine(x));
    MatrixXd by_stage(Rows(), kToolStage);
    Index row = 0;
    for (Index i = 0; i < points_.points().count(); ++i) {
      for (const Index axis : shown_) {
        by_stage.row(row++) = R.row(axis) * by_motions.middleRows<3>(3 * i) / sd_(axis, i);
      }
    }
    return std::make_shared<PlaceResponse>(std::move(by_stage), place_(shown_, Eigen::all),
                                           sd_(shown_, Eigen::all));
  }

 private:
  static constexpr Index kSetup = 6;  // place and turn
  VectorXd Machine(const VectorXd& x) const { return x.segment(kSetup, points_.parameters()); }

  PointsOnMachine points_;
  std::vector<Index> shown_;
  Matrix3Xd place_, sd_;
  bool scaled_;
};

void RefuseNoNoise(const ReferenceRun& run) {
  if (run.sd(AxesShown(run), Eigen::all).minCoeff() > 0.0) return;
  throw InputError(
      fmt::format("{}: the reference has no noise; state reference_um in [linkage.noise] of the "
                  "machine file, u_reference_um in the header or the column ref_u_um, above 0",
                  run.points.name));
}

estimation::ParameterBlock SetupBlock(const std::string& name, const estimation::PrintUnit& unit,
                                      const std::array<const char*, 3>& entries, double prior_sd) {
  estimation::ParameterBlock block(name, unit, {});
  for (const char* entry : entries) block.entries.push_back({.name = entry, .prior_sd = prior_sd});
  return block;
}

}  // namespace

SimulatedRun SimulateReference(const machine::VolumetricModel& model, const Vector3d& reference,
                               const ReferenceRun& run) {
  RefuseNoNoise(run);
  SimulatedRun simulated{
      run.points.name, "reference", {}, nullptr, estimation::RobustLoss::Huber(kHuberThreshold)};
  simulated.blocks = {
      SetupBlock("reference_place " + run.points.name, {"um", 1e-6}, {"x", "y", "z"},
                 estimation::kNoPrior),
      SetupBlock("reference_turn " + run.points.name, {"urad", 1e-6}, {"a", "b", "c"}, kAlignment)};
  // A direction that the instrument does not show has no place.
  for (std::size_t axis = 0; axis < run.shown.size(); ++axis) {
    simulated.blocks[0].entries[axis].held = !run.shown[axis];
  }
  if (IsLineOfSight(run)) simulated.blocks[1].Hold();
  for (auto& block : model.Blocks()) simulated.blocks.push_back(std::move(block));
  if (run.u_scale > 0.0) {
    simulated.blocks.push_back({"reference_scale " + run.points.name,
                                {"ppm", 1e-6},
                                {{.name = "scale", .prior_sd = run.u_scale}}});
  }
  const auto residual = std::make_shared<ReferenceResidual>(model, reference, run);
  simulated.residual = simulated.response = residual;
  simulated.heading = HeadingsOf(run.points.axes);
  simulated.commanded = run.points.axes;
  simulated.times = run.time;
  if (run.tested != ' ') simulated.heading.row(run.tested - 'X') = ApproachOf(run.direction);
  return simulated;
}

SimulatedRun SimulateReference(const machine::VolumetricModel& model, const Vector3d& reference,
                               double sd, const recording::Recording& recording) {
  ReferenceRun run = ReadReferenceRun(recording);
  SetNoise(Vector3d::Constant(sd), run);
  return SimulateReference(model, reference, run);
}

}  // namespace abbe::simulation
