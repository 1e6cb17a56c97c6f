#include "fusion/specimen_check.h"

#include <cmath>

#include "simulation/points/length_simulation.h"
#include "simulation/points/machine_points.h"

namespace abbe::fusion {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

std::vector<SpecimenLength> CheckSpecimen(const map::ErrorMap& map,
                                          const recording::Recording& recording) {
  const auto read = simulation::ReadMachinePoints(recording);
  const auto lengths = simulation::ReadLengths(recording, read);
  const simulation::PointsOnMachine points(map.model(), map.origin().reference, read);
  const Matrix3Xd before = points.Places(Eigen::VectorXd::Zero(points.parameters()));
  std::vector<Matrix3Xd> J;
  const Matrix3Xd after = points.Places(map.model().Parameters(), &J);
  std::vector<SpecimenLength> checked;
  for (const simulation::Length& each : lengths) {
    const Vector3d apart = after.col(each.to) - after.col(each.from);
    const Eigen::RowVectorXd J_length =
        apart.normalized().transpose() * (J[each.to] - J[each.from]);
    checked.push_back({read.rows[each.to], each.length,
                       (before.col(each.to) - before.col(each.from)).norm(), apart.norm(),
                       std::sqrt(J_length * map.cov_pp() * J_length.transpose())});
  }
  return checked;
}

}  // namespace abbe::fusion
