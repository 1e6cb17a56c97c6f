// Mains pick-up: 50 or 60 Hz in a channel, aliased by the pace of the readings.
//
// The frequency of the mains wanders by some hundredths of a hertz, and no recording knows the phase
// at which it began: sine and cosine are random functions of time, straight between nodes, with nodes
// of its own for each run. The amplitude is sqrt(2) times the deviation of their draws.
#include <algorithm>
#include <cmath>

#include "estimation/readings_at_rest.h"
#include "simulation/causes/registry.h"

namespace abbe::simulation {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

constexpr Index kMainsNodes = 80;
constexpr double kUsualDraw = 0.2e-6;  // m, of a draw
constexpr double kNodesApart =
    8.0;  // s: the phase turns by half a radian where the mains is off by 10 mHz

// [deviation of a draw, that stated, Hz], then of each node its run and the time, s.
constexpr Index kHertz = 2, kFirstNode = 3;

Index NodesOf(const Trace& trace, double apart) {
  return 1 + static_cast<Index>((trace.time.maxCoeff() - trace.time.minCoeff()) / apart);
}

VectorXd NodesIn(const Scene& scene, double frequency) {
  std::vector<const Trace*> read;
  for (const Trace* trace : scene.traces) {
    const bool is_known = std::ranges::any_of(
        read, [&](const Trace* other) { return other->identity() == trace->identity(); });
    if (trace->head && trace->rows() > 0 && !is_known && std::ssize(read) < kMainsNodes) {
      read.push_back(trace);
    }
  }
  const auto all = [&](double apart) {
    Index count = 0;
    for (const Trace* trace : read) count += NodesOf(*trace, apart);
    return count;
  };
  double apart = kNodesApart;
  while (all(apart) > kMainsNodes) apart *= 1.1;
  VectorXd shape = VectorXd::Constant(kFirstNode + 2 * kMainsNodes, -1.0);
  shape.head<kFirstNode>() << kUsualDraw, 0.0, frequency;
  Index at = kFirstNode;
  for (const Trace* trace : read) {
    const Index count = NodesOf(*trace, apart);
    const auto times = VectorXd::LinSpaced(count, trace->time.minCoeff(), trace->time.maxCoeff());
    for (Index i = 0; i < count; ++i, at += 2) shape.segment<2>(at) << trace->identity(), times[i];
  }
  return shape;
}

// How much each node counts in each row, nodes x rows: straight from node to node.
MatrixXd WeightsOf(const Trace& trace, const VectorXd& shape) {
  MatrixXd weights = MatrixXd::Zero(kMainsNodes, trace.rows());
  const auto time_of = [&](Index node) { return shape[kFirstNode + 2 * node + 1]; };
  std::vector<Index> own;
  for (Index node = 0; node < kMainsNodes; ++node) {
    if (shape[kFirstNode + 2 * node] != trace.identity()) continue;
    if (!own.empty() && time_of(node) <= time_of(own.back())) break;  // of another run of that name
    own.push_back(node);
  }
  for (Index row = 0; row < trace.rows() && !own.empty(); ++row) {
    std::size_t after = 0;
    while (after < own.size() && time_of(own[after]) < trace.time[row]) ++after;
    if (after == 0 || after == own.size()) {
      weights(own[std::min(after, own.size() - 1)], row) = 1.0;
      continue;
    }
    const double before = time_of(own[after - 1]);
    const double part = (trace.time[row] - before) / (time_of(own[after]) - before);
    weights(own[after - 1], row) = 1.0 - part;
    weights(own[after], row) = part;
  }
  return weights;
}

}  // namespace

Cause MainsPickup() {
  return {
      .id = "mains-pickup",
      .words = {.what = "a channel picks up the mains",
                .shows = "a line at the mains frequency, aliased, in a channel that holds still",
                .check = "grounding and shielding of the cable, switched power supplies nearby",
                .remedy = "ground at one point, average over full mains periods"},
      .keys = {{"frequency_hz", 1.0, 1.0, 1000.0}, {"amplitude_um", 1e-6, 0.0, 100.0}},
      .plausible = VectorXd::Ones(2 * kMainsNodes),
      .objects = ProbesOf,
      .columns = [](const Trace& trace, const Object& object,
                    const VectorXd& shape) -> std::vector<Disturbance> {
        if (!trace.head) return {};
        const Index stage = kReadingStage + object.first();
        const auto waves = LineInStage(trace, stage, shape[kHertz], trace.time);
        const MatrixXd weights = WeightsOf(trace, shape);
        std::vector<Disturbance> columns(2 * kMainsNodes, NoDisturbance(trace));
        for (Index node = 0; node < kMainsNodes; ++node) {
          if (weights.row(node).isZero(0.0)) continue;
          for (Index i = 0; i < 2; ++i) {
            const RowVectorXd& wave = waves[i].stages().at(stage);
            columns[2 * node + i].row(stage) = weights.row(node).cwiseProduct(wave);
          }
        }
        return columns;
      },
      .shapes = [](const Scene& scene) -> std::vector<VectorXd> {
        std::vector<VectorXd> shapes;
        shapes.reserve(std::size(estimation::kMains));
        for (const double mains : estimation::kMains) shapes.push_back(NodesIn(scene, mains));
        return shapes;
      },
      .tell = [](const VectorXd&, const VectorXd& shape) -> VectorXd {
        return Eigen::Vector2d(shape[kHertz], std::numbers::sqrt2 * shape[0]);
      },
      .amount = Amount::kRandomField,
      .fixed_shapes = true,
      .recall = [](const VectorXd& values) -> Recalled {
        return {VectorXd::Zero(2 * kMainsNodes),
                Eigen::Vector3d(values[1] / std::numbers::sqrt2, 0.0, values[0])};
      },
      .follows = Follows::kTime,
  };
}

}  // namespace abbe::simulation
