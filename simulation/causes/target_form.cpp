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
#include <set>

#include "simulation/causes/registry.h"
#include "simulation/sweep/target_spots.h"

namespace abbe::simulation {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

constexpr Index kAlong = 10, kAcross = 4, kNodes = kAlong * kAcross, kUnits = 2;
// One for each swept axis, and one with the head turned: its side unit then sees the opposite face.
constexpr Index kFaces = 6;
constexpr double kUsual = 0.2e-6;      // m
constexpr double kApart = 0.6;         // correlation lengths from node to node at most
constexpr double kSamePlace = 0.1e-3;  // m
constexpr double kRounding = 1e-10;    // of the variance of a node

std::vector<Index> ProbesAt(const Object& object) {
  return object == "target_top" ? std::vector<Index>{0, 1, 2} : std::vector<Index>{3, 4};
}

Index UnitOf(const Object& object) { return object == "target_top" ? 0 : 1; }

Index FaceOf(const Trace& trace, const Object& object) {
  return machine::AxisIndex(trace.axis) +
         (trace.head && trace.head->turned && UnitOf(object) == 1 ? 3 : 0);
}

// All places, in order, each once.
using Places = std::set<long>;  // kSamePlace
void Take(const RowVectorXd& coordinate, Places& places) {
  for (const double each : coordinate) places.insert(std::lround(each / kSamePlace));
}

// Nodes at the places themselves where these are few, the rest so far away that they do nothing;
// else evenly over them.
VectorXd NodesAt(const Places& places, Index count) {
  constexpr double kFarAway = 10.0;  // m
  VectorXd nodes(count);
  for (Index i = 0; i < count; ++i) nodes[i] = kFarAway * (i + 1);
  if (std::ssize(places) > count) {
    return VectorXd::LinSpaced(count, kSamePlace * *places.begin(), kSamePlace * *places.rbegin());
  }
  Index i = 0;
  for (const long place : places) nodes[i++] = kSamePlace * place;
  return nodes;
}

// [standard deviation, that stated, correlation length], then of each face the nodes along, across
// the top, across the side.
constexpr Index kLength = 2, kFirst = 3, kOfFace = kAlong + kUnits * kAcross;

VectorXd GridOver(const Scene& scene) {
  std::array<Places, kFaces> along;
  std::array<std::array<Places, kUnits>, kFaces> across;
  for (const Trace* trace : scene.traces) {
    if (!trace->HasSpots()) continue;
    for (const char* object : {"target_top", "target_side"}) {
      const std::size_t face = FaceOf(*trace, object);
      for (const Index probe : ProbesAt(object)) {
        Take(trace->head->spots.row(2 * probe), along[face]);
        Take(trace->head->spots.row(2 * probe + 1), across[face][UnitOf(object)]);
      }
    }
  }
  VectorXd grid = VectorXd::Zero(kFirst + kOfFace * kFaces);
  grid.head<3>() << kUsual, scene.form, std::max(scene.form_length, kSamePlace);
  for (std::size_t face = 0; face < kFaces; ++face) {
    Index at = kFirst + kOfFace * face;
    const auto add = [&](const Places& places, Index count) {
      grid.segment(at, count) = NodesAt(places, count);
      if (std::ssize(places) > count) {
        grid[kLength] = std::max(grid[kLength], (grid[at + 1] - grid[at]) / kApart);
      }
      at += count;
    };
    add(along[face], kAlong);
    for (const Places& each : across[face]) add(each, kAcross);
  }
  return grid;
}

// The functions of one coordinate, nodes x rows.
MatrixXd FunctionsOf(const RowVectorXd& coordinate, const VectorXd& nodes, double length) {
  const auto covariance = [&](const RowVectorXd& places) -> MatrixXd {
    const MatrixXd apart = nodes.replicate(1, places.size()) - places.replicate(nodes.size(), 1);
    return apart.unaryExpr([&](double each) { return FormCorrelation(each * each, length); });
  };
  MatrixXd among = covariance(nodes.transpose());
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
      .plausible = VectorXd::Ones(kFaces * kNodes),
      .objects = [](const Scene& scene) -> std::vector<Object> {
        if (!scene.HasSweeps()) return {};
        return {"target_top", "target_side"};
      },
      .columns = [](const Trace& trace, const Object& object,
                    const VectorXd& shape) -> std::vector<Disturbance> {
        if (!trace.HasSpots()) return {};
        std::vector<Disturbance> columns(kFaces * kNodes, NoDisturbance(trace));
        const Index face = FaceOf(trace, object), along_at = kFirst + kOfFace * face,
                    across_at = along_at + kAlong + kAcross * UnitOf(object);
        for (const Index probe : ProbesAt(object)) {
          const MatrixXd along = FunctionsOf(trace.head->spots.row(2 * probe),
                                             shape.segment(along_at, kAlong), shape[kLength]),
                         across = FunctionsOf(trace.head->spots.row(2 * probe + 1),
                                              shape.segment(across_at, kAcross), shape[kLength]);
          for (Index node = 0; node < kNodes; ++node) {
            columns[face * kNodes + node].row(kReadingStage + probe) =
                along.row(node / kAcross).cwiseProduct(across.row(node % kAcross));
          }
        }
        return columns;
      },
      .shapes = [](const Scene& scene) -> std::vector<VectorXd> { return {GridOver(scene)}; },
      .tell = [](const VectorXd&, const VectorXd& shape) -> VectorXd { return shape.head(1); },
      .amount = Amount::kRandomField,
      .fixed_shapes = true,
      .recall = [](const VectorXd& values) -> Recalled {
        return {VectorXd::Zero(kFaces * kNodes), VectorXd::Constant(1, values[0])};
      },
  };
}

}  // namespace abbe::simulation
