#include "simulation/length_simulation.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "failure/failure.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kOnePlace = 1e-6;  // m

InputError Bad(const MachinePoints& points, Index i, std::string_view what) {
  return InputError(fmt::format("{}: row {}: {}", points.name,
                                points.rows[static_cast<std::size_t>(i)] + 1, what));
}

class LengthResidual : public estimation::Residual {
 public:
  LengthResidual(PointsOnMachine points, std::vector<Length> lengths, bool scaled)
      : points_(std::move(points)), lengths_(std::move(lengths)), scaled_(scaled) {}

  Index Rows() const override { return static_cast<Index>(lengths_.size()); }

  void Evaluate(const VectorXd& x, VectorXd& values,
                estimation::RowMatrix* jacobian) const override {
    const Index machine = points_.parameters();
    const double scale = scaled_ ? x[machine] : 0.0;
    std::vector<Matrix3Xd> J;
    const Matrix3Xd places = points_.Places(x.head(machine), jacobian == nullptr ? nullptr : &J);
    for (std::size_t k = 0; k < lengths_.size(); ++k) {
      const Length& each = lengths_[k];
      const auto row = static_cast<Index>(k);
      const Vector3d apart = places.col(each.to) - places.col(each.from);
      values[row] = (apart.norm() - each.length * (1.0 + scale)) / each.u;
      if (jacobian == nullptr) continue;
      jacobian->row(row).head(machine) =
          apart.normalized().transpose() *
          (J[static_cast<std::size_t>(each.to)] - J[static_cast<std::size_t>(each.from)]) / each.u;
      if (scaled_) (*jacobian)(row, machine) = -each.length / each.u;
    }
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
  simulated.residual = std::make_shared<LengthResidual>(
      PointsOnMachine(model, reference, std::move(points)), std::move(lengths), u_scale > 0.0);
  return simulated;
}

}  // namespace abbe::simulation
