#include "simulation/correction.h"

#include <algorithm>
#include <cmath>

#include "settings/unit.h"
#include "simulation/correction_steps.h"

namespace abbe::simulation {

using Eigen::Index;
using Eigen::MatrixXd;
using recording::Recording;

namespace {

void CountFromOwn(const Origin& of_model, Trace& trace) {
  Origin origin = OriginOf({&trace});
  if (of_model.started != 0.0) origin.started = of_model.started;
  for (const auto& [sensor, temperature] : of_model.temperature) {
    origin.temperature[sensor] = temperature;
  }
  CountFrom(origin, trace);
  trace.clock = trace.clock.cwiseMax(0.0);  // before that nothing was switched on
}

}  // namespace

void Change::Add(double moved) {
  squares += moved * moved;
  largest = std::max(largest, std::abs(moved));
  ++count;
}

double Change::rms() const { return count == 0 ? 0.0 : std::sqrt(squares / count); }

Sums SumsOf(Trace& trace, const std::vector<ModelledCause>& causes, const Origin& origin) {
  CountFromOwn(origin, trace);
  const MatrixXd none = MatrixXd::Zero(kStages + trace.pivots(), trace.rows());
  Sums sums{none, none};
  for (const ModelledCause& each : causes) {
    if (!each.cause->columns || each.cause->IsRandomField()) continue;
    const auto [coefficients, shape] = each.cause->RecallFrom(each.values);
    const auto columns = each.cause->columns(trace, each.object, shape);
    const bool instrument = each.cause->CorrectedAt(each.object) == CorrectedBy::kInstrument;
    MatrixXd& sum = instrument ? sums.instrument : sums.machine;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      for (const auto& [stage, values] : columns[i].stages()) {
        sum.row(stage) += coefficients[i] * values;
      }
    }
  }
  return sums;
}

Moved::Moved(Recording& recording, const std::string& name, Change& change)
    : unit_(settings::UnitOf(name).si), change_(change) {
  for (auto& column : recording.columns) {
    if (column.name == name) values_ = &column.values;
  }
}

void Moved::By(std::size_t row, double change) {
  if (values_ == nullptr) return;
  (*values_)[row] += change / unit_;
  change_.Add(change);
}

std::string PositionColumn(Index axis) { return std::string(1, "xyz"[axis]) + "_mm"; }

}  // namespace abbe::simulation
