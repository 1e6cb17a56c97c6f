// The offsets of an NC program: coordinate systems G54 to G59.3, G92 and the tool's.
//
//   p_machine = tool + system + turn(rotation) (p_program + g92)
//
// Frames: program coordinates, and the positions of the axes (machine coordinates).
// Shapes: X, Y, Z. Units: m, rad. Failure: none. Validity: linear axes. Source: LinuxCNC 2.9 (order
// of the offsets; the turn of G10 R in XY).
#pragma once

#include <Eigen/Core>
#include <array>

namespace abbe::compensation {

inline constexpr int kSystems = 9;  // G54 G55 G56 G57 G58 G59 G59.1 G59.2 G59.3

struct NcOffsets {
  std::array<Eigen::Vector3d, kSystems> systems;
  std::array<double, kSystems> rotations{};
  std::array<bool, kSystems> is_known{};
  int active = 0;  // index into systems
  Eigen::Vector3d g92 = Eigen::Vector3d::Zero();
  bool g92_acts = false;
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();
  // Where G28 and G30 go, machine coordinates.
  std::array<Eigen::Vector3d, 2> homes;
  std::array<bool, 2> home_is_known{};

  NcOffsets();
  // Positions of the axes from program coordinates.
  Eigen::Vector3d ToMachine(const Eigen::Vector3d& program) const;
  // The inverse.
  Eigen::Vector3d ToProgram(const Eigen::Vector3d& machine) const;
  // Whether X and Y of the program are turned (G10 R).
  bool IsTurned() const { return rotations[active] != 0.0; }
  // G92: the machine position becomes `program` where that is given (not a NaN).
  void SetG92(const Eigen::Vector3d& machine, const Eigen::Vector3d& program);
  // G10 L20: the same by the offset of a system.
  void SetSystem(int index, const Eigen::Vector3d& machine, const Eigen::Vector3d& program);

 private:
  Eigen::Vector3d Turned(const Eigen::Vector3d& p, double sign) const;
};

}  // namespace abbe::compensation
