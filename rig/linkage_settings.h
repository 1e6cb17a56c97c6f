// The values of the table [linkage] of the machine file that the rig uses, read by its own code.
//
// Frames: B, the base of the linkage; M, the machine as the workpiece carries it. SI units. The rig
// builds linkages of two links and three pivots: the form "pivots". InputError with file, line and
// key.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "settings/document.h"

namespace abbe::rig {

struct LinkageSettings {
  double link_1, link_2;
  bool elbow_up;
  bool reach_over;
  Eigen::Matrix3d base_rotation;  // columns x, y, z of B in M, nominal
  Eigen::Vector3d base_position;
  Eigen::Vector3d down;  // in M
  double expansion, reference_temperature;
  std::string temperature;  // column of the links' temperature; empty: constant
  std::vector<int> bearing_harmonics, graduation_harmonics;

  // Standard deviations of the drawn values.
  double link, pivot_angle, pivot_offset, encoder_offset, eccentricity, graduation, bearing;
  double base_place, base_angle, ball, compliance, thermal;
  double seat;  // of the ball against the spindle, in each run
  double encoder_noise, reference_noise, repeatability;
};

LinkageSettings ReadLinkage(const settings::Table& root);

}  // namespace abbe::rig
