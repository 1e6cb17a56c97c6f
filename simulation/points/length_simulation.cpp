#include "simulation/points/length_simulation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "failure/failure.h"
#include "simulation/points/reference_trace.h"
#include "simulation/stage_response.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kOnePlace = 1e-6;  // m

InputError Bad(const MachinePoints& points, Index i, std::string_view what) {
  return InputError(fmt::format("{}: row {}: {}", points.name, points.rows[i] + 1, what));
}

// What moves the points moves the lengths between them.
class LengthResponse : public Response {
 public:
  // `by_stage`: of the points, 3 rows each; `along`: unit vectors of the lengths.
  LengthResponse(MatrixXd by_stage, std::vector<Length> lengths, Matrix3Xd along)
      : by_stage_(std::move(by_stage)),
        points_(by_stage_, 3),
        lengths_(std::move(lengths)),
        along_(std::move(along)) {}

  MatrixXd Columns(const std::vector<Disturbance>& disturbances) const override {
    const MatrixXd moved = points_.Columns(disturbances);
    MatrixXd columns(Rows(), moved.cols());
    for (Index k = 0; k < Rows(); ++k) {
      const Length& each = lengths_[k];
      columns.row(k) = ByPoint(k).transpose() *
                       (moved.middleRows<3>(3 * each.to) - moved.middleRows<3>(3 * each.from));
    }
    return columns;
  }
  MatrixXd Readings(const VectorXd&) const override { return {}; }
  MatrixXd BackToReadings(const MatrixXd& left) const override {
    MatrixXd back = MatrixXd::Zero(by_stage_.rows(), left.cols());
    for (Index k = 0; k < Rows(); ++k) {
      const Length& each = lengths_[k];
      back.middleRows<3>(3 * each.to) += ByPoint(k) * left.row(k);
      back.middleRows<3>(3 * each.from) -= ByPoint(k) * left.row(k);
    }
    return points_.BackToReadings(back);
  }
  MatrixXd BackToStage(Index stage, const MatrixXd& back) const override {
    return points_.BackToStage(stage, back);
  }
  // (a - b)^2 is at most 2 a^2 + 2 b^2.
  Eigen::RowVectorXd WeightsOf(Index stage) const override {
    Eigen::RowVectorXd weights = Eigen::RowVectorXd::Zero(by_stage_.rows() / 3);
    if (stage >= by_stage_.cols()) return weights;
    for (Index k = 0; k < Rows(); ++k) {
      const Length& each = lengths_[k];
      for (const Index point : {each.from, each.to}) {
        weights[point] +=
            2.0 * std::pow(ByPoint(k).dot(by_stage_.col(stage).segment<3>(3 * point)), 2);
      }
    }
    return weights;
  }
  bool RowsAreIndependent() const override { return false; }

 private:
  Index Rows() const { return lengths_.size(); }
  // A longer way leaves more: the residual is what is simulated less what was measured.
  Vector3d ByPoint(Index k) const { return -along_.col(k) / lengths_[k].u; }

  MatrixXd by_stage_;
  StageResponse points_;
  std::vector<Length> lengths_;
  Matrix3Xd along_;
};

class LengthResidual : public Responsive {
 public:
  LengthResidual(const machine::VolumetricModel& model, const Vector3d& reference,
                 MachinePoints points, std::vector<Length> lengths, bool scaled)
      : points_(model, reference, std::move(points)),
        lengths_(std::move(lengths)),
        scaled_(scaled) {}

  Index Rows() const override { return lengths_.size(); }

  void Evaluate(const VectorXd& x, VectorXd& values,
                estimation::RowMatrix* jacobian) const override {
    const Index machine = points_.parameters();
    const double scale = scaled_ ? x[machine] : 0.0;
    std::vector<Matrix3Xd> J;
    const Matrix3Xd places = points_.Places(x.head(machine), jacobian == nullptr ? nullptr : &J);
    for (std::size_t k = 0; k < lengths_.size(); ++k) {
      const Length& each = lengths_[k];
      const Vector3d apart = places.col(each.to) - places.col(each.from);
      values[k] = (apart.norm() - each.length * (1.0 + scale)) / each.u;
      if (jacobian == nullptr) continue;
      jacobian->row(k).head(machine) =
          apart.normalized().transpose() * (J[each.to] - J[each.from]) / each.u;
      if (scaled_) (*jacobian)(k, machine) = -each.length / each.u;
    }
  }

  std::shared_ptr<const Response> At(const VectorXd& x) const override {
    const Matrix3Xd places = points_.Places(x.head(points_.parameters()));
    Matrix3Xd along(3, Rows());
    for (Index k = 0; k < Rows(); ++k) {
      const Length& each = lengths_[k];
      along.col(k) = (places.col(each.to) - places.col(each.from)).normalized();
    }
    return std::make_shared<LengthResponse>(points_.ByMotions(x.head(points_.parameters())),
                                            lengths_, std::move(along));
  }

 private:
  PointsOnMachine points_;
  std::vector<Length> lengths_;
  bool scaled_;
};

}  // namespace

std::vector<Length> ReadLengths(const recording::Recording& recording,
                                const MachinePoints& points) {
  const VectorXd pass = ColumnAt(recording, points, "pass");
  const VectorXd length = ColumnAt(recording, points, "length_mm");
  const VectorXd u = ColumnAt(recording, points, "u_length_um");
  std::vector<Length> lengths;
  Index first = 0;
  for (Index i = 0; i < points.count(); ++i) {
    if (i == 0 || pass[i] != pass[first]) {
      first = i;
      if (length[i] != 0.0) {
        throw Bad(points, i, "the first length of a pass must be 0: others are counted from there");
      }
      if (i + 1 == points.count() || pass[i + 1] != pass[i]) {
        throw Bad(points, i, "a pass of one row has no length; give it a second row");
      }
      continue;
    }
    if (!(length[i] > 0.0)) throw Bad(points, i, "length_mm must be above 0");
    if (!(u[i] > 0.0)) throw Bad(points, i, "u_length_um must be above 0");
    if ((points.axes.col(i) - points.axes.col(first)).norm() < kOnePlace) {
      throw Bad(points, i, "stands where the pass began, but its length is not 0");
    }
    lengths.push_back({first, i, length[i], u[i]});
  }
  return lengths;
}

SimulatedRun SimulateLengths(const machine::VolumetricModel& model, const Vector3d& reference,
                             const recording::Recording& recording) {
  MachinePoints points = ReadMachinePoints(recording);
  std::vector<Length> lengths = ReadLengths(recording, points);
  const double u_scale = 1e-6 * recording.HeaderNumber("u_scale_ppm", 0.0).value_or(0.0);
  SimulatedRun simulated{recording.name, "length", model.Blocks(), nullptr,
                         estimation::RobustLoss::None()};
  if (u_scale > 0.0) {
    simulated.blocks.push_back({"length_scale " + recording.name,
                                {"ppm", 1e-6},
                                {{.name = "scale", .prior_sd = u_scale}}});
  }
  const Trace trace = TraceOf(recording, points);
  simulated.heading = trace.heading;
  simulated.times.resize(std::ssize(lengths));
  std::transform(lengths.begin(), lengths.end(), simulated.times.begin(),
                 [&](const Length& length) { return trace.time[length.to]; });
  const auto residual = std::make_shared<LengthResidual>(model, reference, std::move(points),
                                                         std::move(lengths), u_scale > 0.0);
  simulated.residual = simulated.response = residual;
  return simulated;
}

}  // namespace abbe::simulation
