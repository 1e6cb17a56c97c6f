// Fast evaluation of the volumetric error of a constant machine error model and of its derivatives:
// the same numbers to rounding, an order of magnitude faster.
//
//   const VolumetricField field(model);
//   const Eigen::Vector3d error = field.Error({0.03, 0.02, 0.05}, p_TQ);
//   const Eigen::Matrix3Xd errors = field.Errors(positions, p_TQ);
//   const VolumetricField::Linearized linear = field.Linearize(positions, p_TQ);
//   const Eigen::Matrix3d by_position = linear.J_error_position(0);
//
// Frames, signs, units, shapes: volumetric_model.h. The motions of each axis come from
// axis_motions.h, its line is computed once. Many points are computed as many at once as a vector of
// the processor has numbers, and those of axes that do not move from one to the next are reused.
// Units: m, rad. Shapes: positions and errors in columns, 3 x N; the matrices of one point, 3 x n,
// column by column in one column.
// Failure: InputError for a position outside a travel, naming axis and travel.
// Source: as volumetric_error.h and volumetric_jacobian.h, whose results it repeats to rounding: the
// error of a machine of a metre to 16 eps m, whatever the width of the vectors.
// Validity: a copy of the model at construction.
#pragma once

#include <Eigen/Core>
#include <array>

#include "machine/axis_motions.h"
#include "machine/volumetric_model.h"

namespace abbe::machine {

struct Carriages;
struct PointBlock;

class VolumetricField {
 public:
  explicit VolumetricField(const VolumetricModel& model);

  using Positions = Eigen::Ref<const Eigen::Matrix3Xd>;

  // The error at one position.
  Eigen::Vector3d Error(const Eigen::Vector3d& position, const Eigen::Vector3d& p_TQ) const;
  // At many; fastest where only one axis moves from one to the next.
  Eigen::Matrix3Xd Errors(const Positions& positions, const Eigen::Vector3d& p_TQ) const;

  // The errors of many points with their derivatives. Those by the coefficients of a function are a
  // column of J_error_motions times the gradient of the function.
  class Linearized {
   public:
    template <int kColumns>
    using Columns = Eigen::Map<const Eigen::Matrix<double, 3, kColumns>>;

    // The number of points.
    Eigen::Index size() const { return rows_.cols(); }
    // The error of point i, m.
    Columns<1> error(Eigen::Index i) const { return At<1>(0, i); }
    // Axis by axis, error_motion.h.
    Columns<kAxes * kMotions> J_error_motions(Eigen::Index i) const { return At<18>(3, i); }
    // By [A0Z B0Z C0Y].
    Columns<3> J_error_squareness(Eigen::Index i) const { return At<3>(57, i); }
    // By [X Y Z], with the slopes of the error functions.
    Columns<3> J_error_position(Eigen::Index i) const { return At<3>(66, i); }
    // By p_TQ.
    Columns<3> J_error_tool(Eigen::Index i) const { return At<3>(75, i); }

   private:
    friend class VolumetricField;
    template <int kColumns>
    Columns<kColumns> At(Eigen::Index row, Eigen::Index i) const {
      return Columns<kColumns>(rows_.col(i).data() + row);
    }

    Eigen::Matrix<double, 84, Eigen::Dynamic> rows_;
  };
  // At many positions.
  Linearized Linearize(const Positions& positions, const Eigen::Vector3d& p_TQ) const;
  // The same into memory that was used before.
  void Linearize(const Positions& positions, const Eigen::Vector3d& p_TQ, Linearized& out) const;

 private:
  using AxisErrors = std::array<geometry::ErrorVector<double>, kAxes>;
  Eigen::Vector3d ErrorOf(const Eigen::Vector3d& position, const Eigen::Vector3d& p_TQ,
                          const AxisErrors& errors) const;

  Carriages AllCarriages() const;
  void Fill(const Positions& positions, bool with_slopes, PointBlock& block) const;
  MotionErrors<double> MotionsAt(const PointBlock& block, Eigen::Index i) const;
  template <typename Compute, typename One>
  void InBlocks(const Positions& positions, bool with_slopes, const Compute& compute,
                const One& one) const;
  void LinearizeOne(const Eigen::Vector3d& position, const Eigen::Vector3d& p_TQ,
                    const MotionErrors<double>& motions, const PointBlock& block, Eigen::Index i,
                    double* rows) const;

  Chain chain_;
  Eigen::Vector3d squareness_;
  std::array<Eigen::Vector3d, kAxes> lines_;
  std::array<AxisMotions, kAxes> axes_;
};

}  // namespace abbe::machine
