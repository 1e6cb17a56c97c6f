#include "compensation/nc_offsets.h"

#include <cmath>

namespace abbe::compensation {

using Eigen::Vector3d;

NcOffsets::NcOffsets() {
  systems.fill(Vector3d::Zero());
  homes.fill(Vector3d::Zero());
}

Vector3d NcOffsets::Turned(const Vector3d& p, double sign) const {
  const double angle = sign * rotations[active], c = std::cos(angle), s = std::sin(angle);
  if (angle == 0.0) return p;
  return {c * p.x() - s * p.y(), s * p.x() + c * p.y(), p.z()};
}

Vector3d NcOffsets::ToMachine(const Vector3d& program) const {
  const Vector3d shift = g92_acts ? g92 : Vector3d::Zero();
  return tool + systems[active] + Turned(program + shift, 1.0);
}

Vector3d NcOffsets::ToProgram(const Vector3d& machine) const {
  const Vector3d shift = g92_acts ? g92 : Vector3d::Zero();
  return Turned(machine - tool - systems[active], -1.0) - shift;
}

void NcOffsets::SetG92(const Vector3d& machine, const Vector3d& program) {
  const Vector3d unshifted = Turned(machine - tool - systems[active], -1.0);
  for (int k = 0; k < 3; ++k) {
    if (!g92_acts) g92[k] = std::isnan(program[k]) ? 0.0 : g92[k];
    if (!std::isnan(program[k])) g92[k] = unshifted[k] - program[k];
  }
  g92_acts = true;
}

void NcOffsets::SetSystem(int index, const Vector3d& machine, const Vector3d& program) {
  const int before = active;
  active = index;
  const Vector3d shift = g92_acts ? g92 : Vector3d::Zero();
  Vector3d here = ToProgram(machine);
  for (int k = 0; k < 3; ++k) {
    if (!std::isnan(program[k])) here[k] = program[k];
  }
  systems[index] = machine - tool - Turned(here + shift, 1.0);
  active = before;
}

}  // namespace abbe::compensation
