#include "map/map_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "failure/failure.h"
#include "machine/machine.h"
#include "machine/volumetric_field.h"
#include "standards/coverage.h"

namespace abbe::map {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

double Halton(int index, int base) {
  double value = 0.0, digit = 1.0 / base;
  for (int i = index; i > 0; i /= base, digit /= base) value += digit * (i % base);
  return value;
}

class Comparison {
 public:
  Comparison(const ErrorMap& map, Vector3d p_TQ) : map_(map.model()), p_TQ_(std::move(p_TQ)) {}

  void Add(const Vector3d& position, const Vector3d& other) {
    const Vector3d error = map_.Error(position, p_TQ_);
    const double difference = (other - error).norm();
    if (difference > result_.largest) {
      result_.largest = difference;
      result_.where = position;
    }
    result_.error = std::max(result_.error, error.norm());
    squares_ += difference * difference;
    ++count_;
  }

  Discrepancy Result() const {
    Discrepancy result = result_;
    result.rms = count_ > 0 ? std::sqrt(squares_ / count_) : 0.0;
    return result;
  }

 private:
  machine::VolumetricField map_;
  Vector3d p_TQ_;
  Discrepancy result_;
  double squares_ = 0.0;
  int count_ = 0;
};

}  // namespace

MapGrid::MapGrid(const std::array<GridAxis, 3>& axes, Eigen::Matrix3Xd error, Eigen::Matrix3Xd u95)
    : axes_(axes), error_(std::move(error)), u95_(std::move(u95)) {
  Index points = 1;
  for (int k = 0; k < 3; ++k) {
    const GridAxis& axis = axes_[k];
    if (axis.count < 2 || !(axis.first < axis.last)) {
      throw InputError(fmt::format("a grid of {} points from {} to {} m along {}: give two or more",
                                   axis.count, axis.first, axis.last, "XYZ"[k]));
    }
    points *= axis.count;
    first_[k] = axis.first;
    per_step_[k] = 1.0 / axis.Step();
  }
  if (error_.cols() != points || (u95_.size() > 0 && u95_.cols() != points)) {
    throw InputError(fmt::format("{} errors for a grid of {} points", error_.cols(), points));
  }
}

Vector3d MapGrid::Position(Index point) const {
  const Index x = point % axes_[0].count, rest = point / axes_[0].count;
  return {axes_[0].At(x), axes_[1].At(rest % axes_[1].count), axes_[2].At(rest / axes_[1].count)};
}

Vector3d MapGrid::Error(const Vector3d& position) const {
  Index corner = 0, stride = 3;
  std::array<Index, 3> strides;
  std::array<double, 3> within;
  for (int k = 0; k < 3; ++k) {
    const GridAxis& axis = axes_[k];
    double inside = position[k];
    if (!(inside >= axis.first && inside <= axis.last)) {  // beyond an end: by rounding, or refused
      inside = machine::InTravel({axis.first, axis.last}, k, inside);
    }
    const double steps = (inside - first_[k]) * per_step_[k];
    const Index cell = std::min(static_cast<Index>(steps), axis.count - 2);
    within[k] = steps - cell;
    corner += stride * cell;
    strides[k] = stride;
    stride *= axis.count;
  }
  const auto [x, y, z] = within;
  const std::array<double, 4> weights = {(1 - y) * (1 - z), y * (1 - z), (1 - y) * z, y * z};
  const std::array<Index, 4> edges = {0, strides[1], strides[2], strides[1] + strides[2]};
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const double* at = error_.data() + corner + edges[i];
    const double high = weights[i] * x, low = weights[i] - high;
    for (int k = 0; k < 3; ++k) sum[k] += low * at[k] + high * at[3 + k];
  }
  return sum;
}

MapGrid SampleErrors(const ErrorMap& map, const Vector3d& p_TQ,
                     const std::array<Index, 3>& counts) {
  std::array<GridAxis, 3> axes;
  for (std::size_t k = 0; k < 3; ++k) {
    const machine::Travel& travel = map.model().travels()[k];
    axes[k] = {travel.first, travel.last, counts[k]};
  }
  const Index points = counts[0] * counts[1] * counts[2];
  const MapGrid places(axes, Eigen::Matrix3Xd::Zero(3, points), {});
  Eigen::Matrix3Xd positions(3, points);
  for (Index i = 0; i < points; ++i) positions.col(i) = places.Position(i);
  return {axes, map.model().Errors(positions, p_TQ), {}};
}

MapGrid SampleGrid(const ErrorMap& map, const Vector3d& p_TQ, const std::array<Index, 3>& counts) {
  MapGrid grid = SampleErrors(map, p_TQ, counts);
  if (!map.StatesUncertainty()) return grid;
  Eigen::Matrix3Xd u95(3, grid.size());
  for (Index i = 0; i < grid.size(); ++i) {
    u95.col(i) = standards::kCoverage * map.StandardUncertainty(grid.Position(i), p_TQ);
  }
  return {grid.axes(), grid.error(), std::move(u95)};
}

Discrepancy Compare(const ErrorMap& map, const Vector3d& p_TQ, const ErrorField& field,
                    int points) {
  Comparison comparison(map, p_TQ);
  for (int i = 1; i <= points; ++i) {
    Vector3d position(Halton(i, 2), Halton(i, 3), Halton(i, 5));
    for (int k = 0; k < 3; ++k) {
      const machine::Travel& travel = map.model().travels()[k];
      position[k] = travel.first + (travel.last - travel.first) * position[k];
    }
    comparison.Add(position, field(position));
  }
  return comparison.Result();
}

Discrepancy InterpolationError(const ErrorMap& map, const Vector3d& p_TQ, const MapGrid& grid) {
  Comparison comparison(map, p_TQ);
  const auto& axes = grid.axes();
  for (Index i = 0; i < grid.size(); ++i) {
    const Vector3d corner = grid.Position(i);
    for (int halves = 1; halves < 8; ++halves) {
      Vector3d middle = corner;
      bool is_inside = true;
      for (int k = 0; k < 3; ++k) {
        const GridAxis& axis = axes[k];
        if ((halves >> k & 1) != 0) middle[k] += axis.Step() / 2;
        is_inside = is_inside && middle[k] <= axis.last;
      }
      if (is_inside) comparison.Add(middle, grid.Error(middle));
    }
  }
  return comparison.Result();
}

}  // namespace abbe::map
