#include "fusion/volume_study.h"

#include <Eigen/Dense>
#include <cmath>

#include "fusion/pose_choice.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr int kCheckPoints = 7;  // along each side of the travel, for travel_rms

simulation::LinkageRun Planned(const simulation::LinkageSimulation& simulation,
                               const Matrix3Xd& positions) {
  auto run = simulation::RunAt(positions, simulation.settings());
  run.readings.angles = simulation.Readings(run, simulation.Values());
  return run;
}

double RmsAt(const PoseInformation& where, const MatrixXd& covariance) {
  const MatrixXd JC = where.tip * covariance;
  return std::sqrt(JC.cwiseProduct(where.tip).sum() / where.poses());
}

}  // namespace

Matrix3Xd GridIn(const Travel& travel, const Vector3d& size, const Vector3i& n) {
  const Vector3d centre = 0.5 * (travel.first + travel.last);
  Matrix3Xd positions(3, n.prod());
  Index at = 0;
  for (int k = 0; k < n[2]; ++k) {
    for (int j = 0; j < n[1]; ++j) {
      for (int i = 0; i < n[0]; ++i) {
        const Vector3d share(n[0] > 1 ? i / (n[0] - 1.0) : 0.5, n[1] > 1 ? j / (n[1] - 1.0) : 0.5,
                             n[2] > 1 ? k / (n[2] - 1.0) : 0.5);
        positions.col(at++) = centre + size.cwiseProduct((share.array() - 0.5).matrix());
      }
    }
  }
  return positions;
}

std::vector<VolumeRow> StudyVolumes(const simulation::LinkageSimulation& simulation,
                                    const Travel& travel) {
  const Vector3d whole = travel.last - travel.first;
  const auto x = simulation.Values();
  const PoseInformation everywhere(
      simulation, Planned(simulation, GridIn(travel, whole, Vector3i::Constant(kCheckPoints))), x);
  std::vector<VolumeRow> rows;
  for (const double share : {0.25, 0.5, 0.75, 1.0}) {
    for (const int points : {3, 5, 7, 9}) {
      VolumeRow row{.size = share * whole, .points = Vector3i::Constant(points)};
      const PoseInformation inside(simulation,
                                   Planned(simulation, GridIn(travel, row.size, row.points)), x);
      row.poses = inside.poses();
      const MatrixXd data = inside.white.transpose() * inside.white;
      const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(data);
      row.rank = (eigen.eigenvalues().array() >= 1.0).count();
      const MatrixXd covariance =
          eigen.eigenvectors() *
          (1.0 + eigen.eigenvalues().array()).inverse().matrix().asDiagonal() *
          eigen.eigenvectors().transpose();
      row.inside_rms = RmsAt(inside, covariance);
      row.travel_rms = RmsAt(everywhere, covariance);
      rows.push_back(row);
    }
  }
  return rows;
}

}  // namespace abbe::fusion
