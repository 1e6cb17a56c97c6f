// A sweep as the simulation sees it: what the five probes said at which position of the swept axis.
//
//   const SweepRun run = ReadSweepRun(recording, head, noise);
//
// One row is the mean of all dwells at one station and in one direction of approach, with the
// covariance that white noise and drift leave (probes/sweep_stations.h): what a sweep of any length
// says of the machine, kept in a few hundred numbers.
// Units: m. Shapes: one entry or column per row; covariance rows x rows for each probe.
// Failure: InputError for a recording that is no sweep or has fewer than three stations.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "probes/head_settings.h"
#include "recording/recording.h"

namespace abbe::simulation {

struct SweepRun {
  std::string name;      // of the recording, for messages
  std::string mounting;  // header `mounting`: sweeps that share it share the mounted target
  char axis = 'X';
  Eigen::Vector3d start;                // [x y z] when the sweep began
  Eigen::VectorXd position;             // of the swept axis
  std::vector<int> direction;           // +1, -1
  std::vector<std::size_t> first_rows;  // of the recording: of the first dwell of each row
  Eigen::Matrix<double, probes::kProbes, Eigen::Dynamic> gap;  // as read
  probes::PerProbe<Eigen::MatrixXd> covariance;                // m^2

  Eigen::Index rows() const { return position.size(); }
  Eigen::Vector3d AxesAt(Eigen::Index row) const {
    Eigen::Vector3d axes = start;
    axes[axis - 'X'] = position[row];
    return axes;
  }
};

SweepRun ReadSweepRun(const recording::Recording& recording, const probes::HeadSettings& head,
                      const probes::ProbeNoise& noise);

}  // namespace abbe::simulation
