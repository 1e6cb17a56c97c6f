#include "diagnosis/extended_run.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <utility>

#include "estimation/extended_residual.h"
#include "simulation/causes/registry.h"

namespace abbe::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;
using simulation::SimulatedRun;

void RelaxPriors(const Candidate& cause, std::vector<estimation::ParameterBlock>& blocks) {
  const std::vector<std::string> patterns = cause.cause->relaxes(cause.object);
  for (auto& block : blocks) {
    for (std::size_t i = 0; i < block.entries.size(); ++i) {
      for (std::size_t p = 0; p < patterns.size(); ++p) {
        if (!Matches(block.FullName(i), patterns[p])) continue;
        auto& entry = block.entries[i];
        entry.prior_sd = std::hypot(entry.prior_sd, cause.cause->plausible[p]);
      }
    }
  }
}

// By the logarithm of the shape.
VectorXd ByShape(const LinearRun& at, const Candidate& cause) {
  constexpr double kStep = 1e-7;  // a frequency over an hour is known to a millionth
  Candidate more = cause, less = cause;
  more.shape *= std::exp(kStep);
  less.shape *= std::exp(-kStep);
  return (at.Columns(more) - at.Columns(less)) * cause.coefficients / (2.0 * kStep);
}

// With the noise of exchanged channels where it belongs.
SimulatedRun WithNoiseOf(const SimulatedRun& run, const std::vector<Candidate>& causes) {
  if (!run.noise_exchanged) return run;
  for (const Candidate& cause : causes) {
    if (!cause.cause->exchanges_channels) continue;
    return run.noise_exchanged(cause.object.first(), cause.object.second());
  }
  return run;
}

// What a cause does to the gaps of `read` is taken out of those of `trace`.
void Undo(const Candidate& cause, const simulation::Trace& read, simulation::Trace& trace) {
  for (const auto& each : cause.cause->columns(read, cause.object, cause.shape)) {
    for (const auto& [stage, values] : each.stages()) {
      const Index probe = stage - simulation::kReadingStage;
      if (probe >= 0 && probe < trace.head->gap.rows()) trace.head->gap.row(probe) -= values;
    }
  }
}

// What some causes add to the readings at a shaft, m.
template <typename Which>
RowVectorXd AddedTo(const simulation::Trace& trace, const std::vector<Candidate>& causes,
                    const Which& which) {
  RowVectorXd added = RowVectorXd::Zero(trace.rows());
  for (const Candidate& cause : causes) {
    if (cause.coefficients.size() == 0 || !cause.cause->columns || !which(cause)) continue;
    const auto columns = cause.cause->columns(trace, cause.object, cause.shape);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      for (const auto& [stage, values] : columns[i].stages()) {
        const auto sensor = static_cast<int>(stage - simulation::kReadingStage);
        if (sensor < 0) continue;
        added += cause.coefficients[i] * trace.rim->Of(sensor, values);
      }
    }
  }
  return added;
}

// What the sensors see of the shaft with the causes, and what they make of it.
void LearnFrom(const std::vector<Candidate>& causes, simulation::Trace& trace) {
  constexpr double kStep = 1e-6, kTurn = 1e-3;  // m, rad
  const auto of_shaft = [](const Candidate& cause) { return cause.object == "shaft"; };
  const auto of_sensor = [&](const Candidate& cause) { return !of_shaft(cause); };
  simulation::Trace moved = trace;
  const RowVectorXd here = AddedTo(trace, causes, of_shaft);
  moved.rim->shaft.array() += kTurn;
  const RowVectorXd ahead = AddedTo(moved, causes, of_shaft);
  moved.rim->shaft.array() -= 2.0 * kTurn;
  const RowVectorXd behind = AddedTo(moved, causes, of_shaft);
  trace.rim->by_angle = (ahead - behind) / (2.0 * kTurn);
  trace.rim->by_angle_twice = (ahead - 2.0 * here + behind) / (kTurn * kTurn);
  trace.rim->seen = AddedTo(trace, causes, of_shaft);
  moved = trace;
  moved.rim->seen.array() += kStep;
  const RowVectorXd more = AddedTo(moved, causes, of_sensor) - AddedTo(trace, causes, of_sensor);
  trace.rim->slope = 1.0 + more.array() / kStep;
}

// The columns are slopes where the causes are by now; what they do there, less what these slopes
// make of their coefficients.
VectorXd BesideSlopes(const LinearRun& at) {
  const simulation::RimReadings& rim = *at.trace.rim;
  simulation::Disturbance beside = simulation::NoDisturbance(at.trace);
  for (int sensor = 0; sensor < rim.sensors; ++sensor) {
    beside.row(simulation::kReadingStage + sensor) = (1.0 - rim.slope.array()) * rim.seen.array();
  }
  return at.response->Columns({beside});
}

// What an encoder shows too little at its zero, in a fit: its graduation turns with the shaft.
VectorXd OffsetsOf(const PreparedRun& run, const VectorXd& x) {
  Index first = 0;
  for (const auto& block : run.simulated.blocks) {
    const Index count = block.entries.size();
    if (block.name == "encoder_offset" && count == run.trace.pivots()) {
      return x.segment(first, count);
    }
    first += count;
  }
  return VectorXd::Zero(run.trace.pivots());
}

}  // namespace

void FreeForCauses(const simulation::Scene& scene,
                   std::vector<estimation::ParameterBlock>& blocks) {
  constexpr double kHardly = 0.01;
  for (const simulation::Cause& cause : simulation::Causes()) {
    if (!cause.relaxes) continue;
    for (const simulation::Object& object : cause.objects(scene)) {
      const std::vector<std::string> patterns = cause.relaxes(object);
      for (auto& block : blocks) {
        for (std::size_t i = 0; i < block.entries.size(); ++i) {
          auto& entry = block.entries[i];
          for (std::size_t p = 0; entry.held && p < patterns.size(); ++p) {
            if (!Matches(block.FullName(i), patterns[p])) continue;
            entry.held = false;
            entry.prior_sd = kHardly * cause.plausible[p];
          }
        }
      }
    }
  }
}

std::string BlockOf(const Candidate& cause) { return fmt::format("cause {}", cause.Name()); }

bool Matches(const std::string& full_name, const std::string& pattern) {
  const std::size_t star = pattern.find('*');
  if (star == std::string::npos) return full_name == pattern;
  return full_name.starts_with(pattern.substr(0, star)) &&
         full_name.ends_with(pattern.substr(star + 1));
}

MatrixXd LinearRun::Columns(const Candidate& cause) const {
  if (!response || cause.cause->relaxes) return {};
  const auto disturbances = cause.cause->columns(trace, cause.object, cause.shape);
  return disturbances.empty() ? MatrixXd{} : response->Columns(disturbances);
}

LinearRun LinearAt(const PreparedRun& run, const VectorXd& x, const VectorXd& left,
                   const std::vector<Candidate>& causes) {
  LinearRun at{run.trace, nullptr};
  if (!run.simulated.response) return at;
  at.response = WithNoiseOf(run.simulated, causes).response->At(x);
  if (at.trace.head) at.trace.head->tilt = at.response->Tilts();
  if (at.trace.rim) LearnFrom(causes, at.trace);
  if (left.size() == 0) return at;
  const MatrixXd readings = at.response->Readings(left);
  if (at.trace.pivots() > 0) {
    at.trace.SetAngles(readings.colwise() + OffsetsOf(run, x));
  } else if (at.trace.head) {
    at.trace.head->gap = readings;
    for (const Candidate& cause : causes) {
      if (cause.cause->IsBinary()) Undo(cause, run.trace, at.trace);
    }
  }
  return at;
}

simulation::SimulatedRun Extend(const PreparedRun& run, const LinearRun& at,
                                const std::vector<Candidate>& causes) {
  SimulatedRun extended = WithNoiseOf(run.simulated, causes);
  const auto known = extended.residual;
  const Index rows = run.simulated.residual->Rows();
  VectorXd always = VectorXd::Zero(rows);
  if (at.trace.rim) always += BesideSlopes(at);
  MatrixXd columns(rows, 0);
  for (const Candidate& cause : causes) {
    if (cause.cause->relaxes) {
      RelaxPriors(cause, extended.blocks);
      continue;
    }
    // What is there or not is undone in the readings themselves, noise and all.
    const MatrixXd own = cause.cause->IsBinary() ? LinearRun{run.trace, at.response}.Columns(cause)
                                                 : at.Columns(cause);
    if (own.size() == 0) continue;
    if (cause.cause->IsBinary()) {
      always += own;
      continue;
    }
    estimation::ParameterBlock block(BlockOf(cause), {"", 1.0}, {});
    for (Index i = 0; i < own.cols(); ++i) {
      block.entries.push_back({.name = fmt::format("c{}", i), .prior_sd = cause.Plausible()[i]});
    }
    extended.blocks.push_back(std::move(block));
    columns.conservativeResize(Eigen::NoChange, columns.cols() + own.cols());
    columns.rightCols(own.cols()) = own;
    if (!cause.HasFreeShape()) continue;
    extended.blocks.back().entries.push_back({.name = kShapeEntry, .prior_sd = kShapeFree});
    columns.conservativeResize(Eigen::NoChange, columns.cols() + 1);
    columns.rightCols<1>() = ByShape(at, cause);
  }
  if (columns.cols() == 0 && always.isZero(0.0)) return extended;
  extended.residual =
      std::make_shared<estimation::ExtendedResidual>(known, std::move(always), std::move(columns));
  return extended;
}

}  // namespace abbe::diagnosis
