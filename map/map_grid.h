// An error map on a grid, for programs that use grid points and for fast interpolation at millions
// of points.
//
//   const MapGrid grid = SampleGrid(map, p_TQ, {31, 31, 31});
//   const Eigen::Vector3d error = grid.Error({0.03, 0.02, 0.05});     // trilinear
//   const Discrepancy worst = InterpolationError(map, p_TQ, grid);
//
// Frames, signs: error_map.h.
// Units: m. Shapes: one column per grid point, x runs fastest, then y, then z; u95 is empty for a
// map without uncertainty. u95 = 2 u of each component.
// Failure: InputError for fewer than two points along an axis, and for a position outside the grid.
// Source: own; trilinear interpolation.
// Validity: between the points the error of interpolation is that of InterpolationError,
// proportional to the square of the spacing.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <string>

#include "map/error_map.h"

namespace abbe::map {

// `count` points from `first` to `last`, both included.
struct GridAxis {
  double first = 0.0, last = 0.0;  // m
  Eigen::Index count = 0;

  // m.
  double Step() const { return (last - first) / (count - 1); }
  // Exactly `last` at the end.
  double At(Eigen::Index i) const { return i == count - 1 ? last : first + Step() * i; }
};

class MapGrid {
 public:
  MapGrid(const std::array<GridAxis, 3>& axes, Eigen::Matrix3Xd error, Eigen::Matrix3Xd u95);

  const std::array<GridAxis, 3>& axes() const { return axes_; }
  const Eigen::Matrix3Xd& error() const { return error_; }
  const Eigen::Matrix3Xd& u95() const { return u95_; }
  Eigen::Index size() const { return error_.cols(); }
  // Where a column of error() stands, m.
  Eigen::Vector3d Position(Eigen::Index point) const;

  // Trilinear between the eight points around.
  Eigen::Vector3d Error(const Eigen::Vector3d& position) const;

 private:
  std::array<GridAxis, 3> axes_;
  Eigen::Matrix3Xd error_, u95_;
  Eigen::Vector3d first_, per_step_;
};

// The map at `counts` points along X, Y and Z, over the whole travels, without its U95.
MapGrid SampleErrors(const ErrorMap& map, const Eigen::Vector3d& p_TQ,
                     const std::array<Eigen::Index, 3>& counts);

// The same with the U95, where the map states uncertainties; they take most of the time.
MapGrid SampleGrid(const ErrorMap& map, const Eigen::Vector3d& p_TQ,
                   const std::array<Eigen::Index, 3>& counts);

// Comparison of an error field with a map, m: largest and rms |difference|, the position of the
// largest, and the largest |error| of the map at the compared points.
struct Discrepancy {
  double largest = 0.0, rms = 0.0, error = 0.0;
  Eigen::Vector3d where = Eigen::Vector3d::Zero();
};

// Compares at `points` points that fill the travels evenly and are not on a grid (Halton sequence
// in bases 2, 3, 5).
using ErrorField = std::function<Eigen::Vector3d(const Eigen::Vector3d& position)>;
Discrepancy Compare(const ErrorMap& map, const Eigen::Vector3d& p_TQ, const ErrorField& field,
                    int points = 4000);

// Compares at the middle of every cell, edge and face of the grid, where the error of trilinear
// interpolation is largest.
Discrepancy InterpolationError(const ErrorMap& map, const Eigen::Vector3d& p_TQ,
                               const MapGrid& grid);

}  // namespace abbe::map
