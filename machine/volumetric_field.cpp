#include "machine/volumetric_field.h"

#include <algorithm>
#include <string>

#include "machine/volumetric_jacobian.h"
#include "machine/volumetric_kernels.h"

namespace abbe::machine {
namespace {

using Eigen::Index, Eigen::Vector3d;

AxisMotions MotionsOf(const VolumetricModel& model, int axis) {
  std::array<ErrorFunction, kMotions> functions;
  for (int motion = 0; motion < kMotions; ++motion) {
    functions[motion] = model.Function(axis, motion);
  }
  return {axis, functions, model.travels()[axis]};
}

// exp(turn) v; for small turns without the matrix: sin(a)/a and (1 - cos(a))/a^2 by their series.
Vector3d Turned(const Vector3d& turn, const Vector3d& v) {
  const double square = turn.squaredNorm();
  if (square >= kLargestTurn * kLargestTurn) return geometry::ExpRotation<double>(turn) * v;
  const double sine = 1 - square * (1.0 / 6 - square * (1.0 / 120 - square * (1.0 / 5040)));
  const double versine = 0.5 - square * (1.0 / 24 - square * (1.0 / 720 - square * (1.0 / 40320)));
  const Vector3d across = turn.cross(v);
  return v + sine * across + versine * turn.cross(across);
}

bool HasLargeTurn(const MotionErrors<double>& motions) {
  return std::any_of(motions.axes.begin(), motions.axes.end(), [](const auto& errors) {
    return !(errors.template tail<3>().squaredNorm() < kLargestTurn * kLargestTurn);
  });
}

constexpr Index kBlock = MotionBlock::kBlock;

}  // namespace

VolumetricField::VolumetricField(const VolumetricModel& model)
    : chain_(model.chain()),
      squareness_(model.squareness()),
      lines_{LineOf<double>(0, model.squareness()), LineOf<double>(1, model.squareness()),
             LineOf<double>(2, model.squareness())},
      axes_{MotionsOf(model, 0), MotionsOf(model, 1), MotionsOf(model, 2)} {}

// The equations of volumetric_error.h: the tool point is transformed from carriage to carriage to
// the bed, then from the bed to the workpiece.
Vector3d VolumetricField::ErrorOf(const Vector3d& position, const Vector3d& p_TQ,
                                  const AxisErrors& errors) const {
  Vector3d p = p_TQ;
  const auto shift = [&](std::size_t axis) -> Vector3d {
    const double sense = chain_.CarriageSense("XYZ"[axis]);
    Vector3d way = errors[axis].head<3>() + sense * position[axis] * lines_[axis];
    if (sense < 0.0) way[axis] -= 2.0 * errors[axis][axis];
    return way;
  };
  const std::string& tool = chain_.tool_axes();
  for (auto letter = tool.rbegin(); letter != tool.rend(); ++letter) {
    const std::size_t axis = *letter - 'X';
    p = Turned(errors[axis].tail<3>(), p) + shift(axis);
  }
  const std::string& work = chain_.workpiece_axes();
  for (auto letter = work.rbegin(); letter != work.rend(); ++letter) {
    const std::size_t axis = *letter - 'X';
    p = Turned(-errors[axis].tail<3>(), p - shift(axis));
  }
  return p - NominalToolInWork<double>(chain_, position, p_TQ);
}

Vector3d VolumetricField::Error(const Vector3d& position, const Vector3d& p_TQ) const {
  return ErrorOf(position, p_TQ,
                 {axes_[0].At(position[0]), axes_[1].At(position[1]), axes_[2].At(position[2])});
}

Carriages VolumetricField::AllCarriages() const {
  Carriages all;
  const auto add = [&](char letter, auto& side, int& count) {
    const int axis = letter - 'X';
    side[count++] = {axis, chain_.CarriageSense(letter), lines_[axis],
                     LineJacobian(axis, squareness_)};
  };
  const std::string& work = chain_.workpiece_axes();
  for (auto letter = work.rbegin(); letter != work.rend(); ++letter) {
    add(*letter, all.work, all.work_count);
  }
  for (const char letter : chain_.tool_axes()) add(letter, all.tool, all.tool_count);
  for (int axis = 0; axis < kAxes; ++axis) all.tool_senses[axis] = chain_.ToolSense("XYZ"[axis]);
  return all;
}

MotionErrors<double> VolumetricField::MotionsAt(const PointBlock& block, Index i) const {
  MotionErrors<double> motions;
  motions.squareness = squareness_;
  for (int axis = 0; axis < kAxes; ++axis) {
    for (int motion = 0; motion < kMotions; ++motion) {
      motions.axes[axis][motion] = block.motions[axis].At(i, motion);
    }
  }
  return motions;
}

// The positions of a block and the motions of its axes.
void VolumetricField::Fill(const Positions& positions, bool with_slopes, PointBlock& block) const {
  const auto count = static_cast<std::size_t>(positions.cols());
  for (int axis = 0; axis < kAxes; ++axis) {
    double* const places = block.positions[axis];
    for (std::size_t i = 0; i < count; ++i) places[i] = positions(axis, i);
    axes_[axis].At({places, count}, block.motions[axis],
                   with_slopes ? &block.slopes[axis] : nullptr);
  }
}

// Block by block: compute(first point, points, block) by vectors, which returns the square of the
// largest turn; one(point, its motions, block, place in it) where turns are too large for that.
template <typename Compute, typename One>
void VolumetricField::InBlocks(const Positions& positions, bool with_slopes, const Compute& compute,
                               const One& one) const {
  PointBlock block;
  for (Index first = 0; first < positions.cols(); first += kBlock) {
    const Index count = std::min(kBlock, positions.cols() - first);
    Fill(positions.middleCols(first, count), with_slopes, block);
    if (compute(first, static_cast<int>(count), block) < kLargestTurn * kLargestTurn) continue;
    for (Index i = 0; i < count; ++i) {
      const MotionErrors<double> motions = MotionsAt(block, i);
      if (HasLargeTurn(motions)) one(first + i, motions, block, i);
    }
  }
}

Eigen::Matrix3Xd VolumetricField::Errors(const Positions& positions, const Vector3d& p_TQ) const {
  Eigen::Matrix3Xd result(3, positions.cols());
  const Carriages carriages = AllCarriages();
  InBlocks(
      positions, false,
      [&](Index first, int count, const PointBlock& block) {
        return BlockErrors(carriages, p_TQ, block, count, result.col(first).data());
      },
      [&](Index point, const MotionErrors<double>& motions, const PointBlock&, Index) {
        result.col(point) = ErrorOf(positions.col(point), p_TQ, motions.axes);
      });
  return result;
}

VolumetricField::Linearized VolumetricField::Linearize(const Positions& positions,
                                                       const Vector3d& p_TQ) const {
  Linearized result;
  Linearize(positions, p_TQ, result);
  return result;
}

void VolumetricField::Linearize(const Positions& positions, const Vector3d& p_TQ,
                                Linearized& out) const {
  static_assert(kRows == int{decltype(out.rows_)::RowsAtCompileTime});
  out.rows_.resize(Eigen::NoChange, positions.cols());
  const Carriages carriages = AllCarriages();
  InBlocks(
      positions, true,
      [&](Index first, int count, const PointBlock& block) {
        return BlockDerivatives(carriages, p_TQ, block, count, out.rows_.col(first).data());
      },
      [&](Index point, const MotionErrors<double>& motions, const PointBlock& block, Index i) {
        LinearizeOne(positions.col(point), p_TQ, motions, block, i, out.rows_.col(point).data());
      });
}

// With the rotations of any size.
void VolumetricField::LinearizeOne(const Vector3d& position, const Vector3d& p_TQ,
                                   const MotionErrors<double>& motions, const PointBlock& block,
                                   Index i, double* rows) const {
  VolumetricJacobian J = VolumetricErrorAndJacobian(chain_, position, p_TQ, motions);
  for (int axis = 0; axis < kAxes; ++axis) {
    for (int motion = 0; motion < kMotions; ++motion) {
      J.J_error_position.col(axis) +=
          block.slopes[axis].At(i, motion) * J.J_error_motions.col(kMotions * axis + motion);
    }
  }
  const auto put = [&](const auto& matrix, int row) {
    std::copy_n(matrix.data(), matrix.size(), rows + row);
  };
  put(J.error, kOfError);
  put(J.J_error_motions, kByMotions);
  put(J.J_error_squareness, kBySquareness);
  put(J.J_error_position, kByPosition);
  put(J.J_error_tool, kByTool);
}

}  // namespace abbe::machine
