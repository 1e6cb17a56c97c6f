// The correction of positions by an error map: the command that brings the tool to a wanted
// position, and the position that a command produces.
//
//   const Corrector corrector(map, p_TQ);
//   const Eigen::Vector3d command = corrector.Command(wanted);
//   corrector.Made(command);                                        // wanted, to rounding
//
// Frames: positions are axis positions [X Y Z] as commanded and read from the scales; a position of
// the tool in the workpiece is given by the axis positions of a perfect machine for it. The error E
// is in W, so the correction of an axis has the sign of its ToolSense (machine/chain.h):
//
//   Made(c) = c + S E(c)        Command(d): c = d - S E(c), by fixed point      S = diag(signs)
//
// KeepZero(z): a zero that was touched off at the axis positions z already contains the error of
// the tool there, S E(z). It is subtracted everywhere, so that Command(z) = z and all other
// positions are corrected relative to it.
// A command may exceed the travels as far as the soft limits; the errors there are those at the end
// of the travel. A reading may exceed them only as far as the command for a place inside does.
//
// Units: m. Failure: InputError when `wanted` is outside the travels, a reading and its place are,
// or a position or the command is beyond the soft limits; NumericalError for a map whose errors
// grow as fast as the position, which has no inverse. Source: Ha and Khanh (2011) take the first step of the
// iteration, X - E(X); it neglects the error times its slope, 0.01 um for 100 um that grow by 100
// um/m. Validity: slopes of the error well below 1.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "machine/volumetric_field.h"
#include "map/error_map.h"

namespace abbe::compensation {

class Corrector {
 public:
  using Limits = std::array<machine::Travel, 3>;

  Corrector(const map::ErrorMap& map, const Eigen::Vector3d& p_TQ)
      : Corrector(map.model(), p_TQ, map.Limits()) {}
  Corrector(const machine::VolumetricModel& model, const Eigen::Vector3d& p_TQ)
      : Corrector(model, p_TQ, machine::AroundTravels(model.travels())) {}
  Corrector(const machine::VolumetricModel& model, const Eigen::Vector3d& p_TQ,
            const Limits& limits);

  void KeepZero(const Eigen::Vector3d& zero);
  // Another tool, which is taken to have touched the zero itself: the place does not move with it.
  void SetTool(const Eigen::Vector3d& p_TQ);
  // S.
  const Eigen::Vector3d& signs() const { return signs_; }
  // Whether the machine has the axis: a lathe has no Y, and what it errs by there stays.
  bool Has(int axis) const { return travels_[axis].last > travels_[axis].first; }

  Eigen::Vector3d Made(const Eigen::Vector3d& position) const {
    return position + Offset(position);
  }
  // Made, for a reading of the scales.
  Eigen::Vector3d MadeOfReading(const Eigen::Vector3d& reading) const;
  Eigen::Vector3d Command(const Eigen::Vector3d& wanted) const;

 private:
  Eigen::Vector3d Offset(const Eigen::Vector3d& position) const {
    return signs_.cwiseProduct(field_.Error(InTravels(position), p_TQ_)) - at_zero_;
  }
  // The position, or the end of the travel if it is between there and the soft limit.
  Eigen::Vector3d InTravels(const Eigen::Vector3d& position) const;

  machine::VolumetricField field_;
  std::array<machine::Travel, 3> travels_;
  Limits limits_;
  Eigen::Vector3d p_TQ_, signs_, at_zero_ = Eigen::Vector3d::Zero();
  std::optional<Eigen::Vector3d> zero_;
};

// The length of a straight line of commands between two corrected points that deviates from the
// corrected line by at most `tolerance`, m:
//
//   length = sqrt(8 tolerance / curvature)
//
// with the largest curvature of the correction along the axes and the diagonals of the volume.
double LineLength(const Corrector& corrector, const machine::VolumetricModel& model,
                  double tolerance);

}  // namespace abbe::compensation
