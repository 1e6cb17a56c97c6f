// Positions at which a known thing met the tool point: read from recordings of kind reference,
// length and plate, and the common part of their simulation.
//
// Tool point Q: header `tool_mm` = [x, y, z], where Q stands in M when all axes are at zero;
// without it the machine's origin.
// Frames: M, the machine frame as the workpiece carries it.
// Units: m. Shapes: points in columns, 3 x N.
// Failure: InputError with recording and row for a missing column, a number that is not finite, a
// position outside the travels.
// Source: machine/volumetric_error.h for p_MQ.
// Validity: the tool point is rigid with the tool body.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "machine/volumetric_model.h"
#include "recording/recording.h"

namespace abbe::simulation {

struct MachinePoints {
  std::string name;                                // of the recording, for messages
  std::vector<std::size_t> rows;                   // of the recording: those without a flag
  Eigen::Matrix3Xd axes;                           // positions [x y z]
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();  // Q with all axes at zero, in M

  Eigen::Index count() const { return axes.cols(); }
};

// A point of the header in mm, as m; empty when the header has no such key.
std::optional<Eigen::Vector3d> HeaderPoint(const recording::Recording& recording,
                                           const std::string& key);

// Rows without a flag.
MachinePoints ReadMachinePoints(const recording::Recording& recording);

// A column of the recording in the rows of `points`, SI.
Eigen::VectorXd ColumnAt(const recording::Recording& recording, const MachinePoints& points,
                         const std::string& column);

// p_MQ of each point on the machine of `model`, and its derivatives by the model's parameters.
class PointsOnMachine {
 public:
  // `reference`: the machine's reference point, m, in M.
  PointsOnMachine(machine::VolumetricModel model, const Eigen::Vector3d& reference,
                  MachinePoints points);

  const MachinePoints& points() const { return points_; }
  Eigen::Index parameters() const { return model_.ParameterCount(); }

  // J_p_x: 3 x parameters for each point, side by side; may be null.
  Eigen::Matrix3Xd Places(const Eigen::VectorXd& machine_parameters,
                          std::vector<Eigen::Matrix3Xd>* J_p_x = nullptr) const;
  // Derivatives of the places by the error motions of the axes (simulation/disturbance.h): 3 rows
  // for each point.
  Eigen::MatrixXd ByMotions(const Eigen::VectorXd& machine_parameters) const;

 private:
  machine::VolumetricModel model_;
  MachinePoints points_;
  Eigen::Vector3d tool_;      // Q from the reference point
  Eigen::Matrix3Xd nominal_;  // p_MQ of a perfect machine
};

}  // namespace abbe::simulation
