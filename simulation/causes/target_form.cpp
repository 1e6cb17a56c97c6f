// Target form: the faces of the target are less flat than the machine file says, by a random
// function that goes with the target when it is shifted or reversed.
//
// A Gaussian process of the correlation length of the machine file, known at a grid of nodes over
// all that the probes see of a face; each swept axis has its own. With k the covariance to the
// nodes and L L' that among them, its functions are L^-1 k: draws of one standard deviation are
// forms of that deviation (Rasmussen and Williams, Gaussian Processes (2006), 8.1). On an axis that
// is longer than nine times 0.6 correlation lengths the length is what the grid can hold.
#include <Eigen/Cholesky>
#include <array>
#include <limits>

#include "simulation/causes/registry.h"

namespace abbe::simulation {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

constexpr Index kAlong = 10, kAcross = 4, kNodes = kAlong * kAcross, kAxes = 3, kUnits = 2;
constexpr double kUsual = 0.2e-6;    // m
constexpr double kApart = 0.6;       // correlation lengths from node to node at most
constexpr double kSameLine = 1e-6;   // m
constexpr double kRounding = 1e-10;  // of the variance of a node

std::vector<Index> ProbesAt(const std::string& object) {
  return object == "target_top" ? std::vector<Index>{0, 1, 2} : std::vector<Index>{3, 4};
}

struct Range {
  double first = std::numeric_limits<double>::infinity(), last = -first;

  void Take(const RowVectorXd& values) {
    first = std::min(first, values.minCoeff());
    last = std::max(last, values.maxCoeff());
  }
  bool any() const { return last >= first; }
};

Index UnitOf(const std::string& object) { return object == "target_top" ? 0 : 1; }

// [standard deviation, correlation length], then of each axis: first node and spacing along, across
// the top, across the side.
constexpr Index kLength = 1, kFirst = 2, kOfAxis = 2 * (1 + kUnits);

VectorXd GridOver(const Scene& scene) {
  std::array<Range, kAxes> along;
  std::array<std::array<Range, kUnits>, kAxes> across;
  for (const Trace* trace : scene.traces) {
    if (trace->spots.size() == 0) continue;
    const auto axis = static_cast<std::size_t>(AxisOf(trace->axis));
    for (const char* object : {"target_top", "target_side"}) {
      for (const Index probe : ProbesAt(object)) {
        along[axis].Take(trace->spots.row(2 * probe));
        across[axis][static_cast<std::size_t>(UnitOf(object))].Take(
            trace->spots.row(2 * probe + 1));
      }
    }
  }
  VectorXd grid = VectorXd::Zero(kFirst + kOfAxis * kAxes);
  grid.head<2>() << kUsual, std::max(scene.form_length, 1e-3);
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    Index at = kFirst + kOfAxis * static_cast<Index>(axis);
    const auto add = [&](const Range& range, Index nodes) {
      if (!range.any()) return;
      grid[at++] = range.first;
      grid[at++] = (range.last - range.first) / static_cast<double>(nodes - 1);
      grid[kLength] = std::max(grid[kLength], grid[at - 1] / kApart);
    };
    add(along[axis], kAlong);
    for (const Range& each : across[axis]) add(each, kAcross);
  }
  return grid;
}

// The functions of one coordinate, nodes x rows; of a line of one place only the first.
MatrixXd FunctionsOf(const RowVectorXd& coordinate, double first, double spacing, double length,
                     Index nodes) {
  if (spacing < kSameLine) {
    MatrixXd one = MatrixXd::Zero(nodes, coordinate.size());
    one.row(0).setOnes();
    return one;
  }
  const VectorXd at =
      VectorXd::LinSpaced(nodes, first, first + spacing * static_cast<double>(nodes - 1));
  const auto covariance = [&](const RowVectorXd& places) -> MatrixXd {
    const MatrixXd apart = at.replicate(1, places.size()) - places.replicate(nodes, 1);
    return (-0.5 * (apart / length).array().square()).exp();
  };
  MatrixXd among = covariance(at.transpose());
  among.diagonal().array() += kRounding;
  return among.llt().matrixL().solve(covariance(coordinate));
}

}  // namespace

Cause TargetForm() {
  return {
      .id = "target-form",
      .words = {.what = "a face of the target is less flat than the machine file says",
                .shows = "waves in the probes of one unit, shifted from probe to probe by their "
                         "distance; they move with the target",
                .check = "flatness of the face; sweep again with the target shifted or reversed",
                .remedy = "lap or replace the target, or state its flatness (target.form_nm)"},
      .keys = {{"rms_um", 1e-6, 0.0, 100.0}},
      .plausible = VectorXd::Ones(kAxes * kNodes),
      .objects = [](const Scene& scene) -> std::vector<std::string> {
        if (!scene.HasSweeps()) return {};
        return {"target_top", "target_side"};
      },
      .columns = [](const Trace& trace, const std::string& object,
                    const VectorXd& shape) -> std::vector<Disturbance> {
        if (trace.spots.size() == 0) return {};
        std::vector<Disturbance> columns(kAxes * kNodes, NoDisturbance(trace));
        const Index axis = AxisOf(trace.axis), along_at = kFirst + kOfAxis * axis,
                    across_at = along_at + 2 * (1 + UnitOf(object));
        for (const Index probe : ProbesAt(object)) {
          const MatrixXd along = FunctionsOf(trace.spots.row(2 * probe), shape[along_at],
                                             shape[along_at + 1], shape[kLength], kAlong),
                         across = FunctionsOf(trace.spots.row(2 * probe + 1), shape[across_at],
                                              shape[across_at + 1], shape[kLength], kAcross);
          for (Index node = 0; node < kNodes; ++node) {
            columns[static_cast<std::size_t>(axis * kNodes + node)].row(kReadingStage + probe) =
                along.row(node / kAcross).cwiseProduct(across.row(node % kAcross));
          }
        }
        return columns;
      },
      .shapes = [](const Scene& scene) -> std::vector<VectorXd> { return {GridOver(scene)}; },
      .tell = [](const VectorXd&, const VectorXd& shape) -> VectorXd { return shape.head(1); },
      .fixed_shapes = true,
      .recall = [](const VectorXd& values) -> Recalled {
        return {VectorXd::Zero(kAxes * kNodes), VectorXd::Constant(1, values[0])};
      },
      .drawn = true,
  };
}

}  // namespace abbe::simulation
