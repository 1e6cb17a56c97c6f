#include "diagnosis/where_it_shows.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "fusion/machine_problem.h"
#include "machine/volumetric_jacobian.h"
#include "simulation/variables.h"

namespace abbe::diagnosis {
namespace {

using Eigen::Index;
using Eigen::RowVectorXd;
using Eigen::VectorXd;
using simulation::Trace;
using simulation::UnitOf;
using simulation::ValuesOf;
using simulation::VariablesOf;

constexpr int kParts = 24;        // of the range of a variable
constexpr double kTells = 1.0;    // largest effect over the noise of a part, squared
constexpr double kKept = 0.5;     // of the effect, below which a variable does not show it
constexpr double kClearly = 1.5;  // how much more another variable has to keep than its own

// What a cause does in the rows of a run, stage by stage.
std::map<Index, RowVectorXd> EffectOf(const Score& score, const Trace& trace) {
  std::map<Index, RowVectorXd> effect;
  const Candidate& cause = score.candidate;
  if (!cause.cause->columns) return effect;
  const auto columns = cause.cause->columns(trace, cause.object, cause.shape);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    for (const auto& [stage, values] : columns[c].stages()) {
      const RowVectorXd own = score.coefficients[c] * values;
      const auto [known, added] = effect.try_emplace(stage, own);
      if (!added) known->second += own;
    }
  }
  return effect;
}

// Which way the object moves: +1, -1, 0.
RowVectorXd HeadingOf(const simulation::Object& object, const Trace& trace) {
  if (object.kind() == simulation::Object::Kind::kPivot && trace.linkage) {
    return trace.linkage->heading.row(object.first());
  }
  if (object.IsOfAxes()) return trace.heading.row(object.first());
  return RowVectorXd::Zero(trace.rows());
}

// The one that moves: "x" of the axis X, "pivot_2".
std::string OwnVariable(const simulation::Object& object) {
  if (object.kind() == simulation::Object::Kind::kPivot) return object.name();
  return std::string(1, static_cast<char>(std::tolower(object.name()[0])));
}

struct Rows {
  std::size_t run;
  RowVectorXd effect, weights, before, after, heading;
};

std::vector<Rows> RowsAt(const Fit& base, const Fit& found, const Score& score) {
  std::vector<std::map<Index, RowVectorXd>> effects;
  std::map<Index, double> seen;
  for (std::size_t run = 0; run < found.runs(); ++run) {
    effects.push_back(EffectOf(score, found.TraceOf(run)));
    for (const auto& [stage, effect] : effects.back()) {
      const auto of_run = found.ScoresOf(run, stage);
      if (of_run.weights.size() > 0) seen[stage] += of_run.weights.dot(effect.cwiseAbs2());
    }
  }
  std::vector<Rows> rows;
  if (seen.empty()) return rows;
  const Index stage = std::max_element(seen.begin(), seen.end(), [](const auto& a, const auto& b) {
                        return a.second < b.second;
                      })->first;
  for (std::size_t run = 0; run < found.runs(); ++run) {
    const auto effect = effects[run].find(stage);
    if (effect == effects[run].end()) continue;
    const auto left = found.ScoresOf(run, stage), unexplained = base.ScoresOf(run, stage);
    if (left.weights.size() == 0 || unexplained.weights.size() != left.weights.size()) continue;
    const auto by_row = [](const Fit::RowScores& all) -> RowVectorXd {
      return (all.weights.array() > 0.0).select(all.scores.array() / all.weights.array(), 0.0);
    };
    const double weight = left.weights.sum();
    if (!(weight > 0.0)) continue;
    // What is the same in all rows of a run, its own zeros explain as well.
    const double always = left.weights.dot(effect->second) / weight;
    rows.push_back({run, effect->second.array() - always, left.weights, by_row(unexplained),
                    by_row(left), HeadingOf(score.candidate.object, found.TraceOf(run))});
  }
  return rows;
}

estimation::PrintUnit UnitAt(const Score& score, const Trace& trace) {
  for (const auto& [stage, effect] : EffectOf(score, trace)) {
    const bool turn = stage >= simulation::kEncoderStage ||
                      (stage < simulation::kToolStage && stage % machine::kMotions >= 3);
    return turn ? estimation::kMicroradians : estimation::kMicrometres;
  }
  return {"um", 1e-6};
}

// Weighted sums over one part of the range and one direction.
struct Part {
  double weight = 0.0, at = 0.0, effect = 0.0, before = 0.0, after = 0.0;
};

struct Parted {
  std::vector<Part> parts;
  double kept = 0.0;  // of the effect, weighted square sum
};

Parted PartedBy(const std::string& variable, const Fit& found, const std::vector<Rows>& rows) {
  double first = std::numeric_limits<double>::infinity(), last = -first;
  std::vector<RowVectorXd> values;
  for (const Rows& each : rows) {
    values.push_back(ValuesOf(variable, found.TraceOf(each.run)));
    if (values.back().size() == 0) continue;
    first = std::min(first, values.back().minCoeff());
    last = std::max(last, values.back().maxCoeff());
  }
  Parted parted;
  if (!(last > first)) return parted;
  parted.parts.resize(3 * kParts);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (Index row = 0; row < values[r].size(); ++row) {
      const double share = (values[r][row] - first) / (last - first);
      const int place = std::min(kParts - 1, static_cast<int>(share * kParts));
      const int heading = static_cast<int>(rows[r].heading[row]);
      Part& part = parted.parts[3 * place + heading + 1];
      const double weight = rows[r].weights[row];
      part.weight += weight;
      part.at += weight * values[r][row];
      part.effect += weight * rows[r].effect[row];
      part.before += weight * rows[r].before[row];
      part.after += weight * rows[r].after[row];
    }
  }
  double most = 0.0;
  for (const Rows& each : rows) most = std::max(most, each.effect.cwiseAbs2().maxCoeff());
  std::erase_if(parted.parts, [&](const Part& part) { return part.weight * most <= kTells; });
  for (const Part& part : parted.parts) parted.kept += part.effect * part.effect / part.weight;
  return parted;
}

}  // namespace

Curve CurveOf(const Fit& base, const Fit& found, std::size_t taken_in) {
  const Score score = found.ScoreOf(taken_in);
  const std::vector<Rows> rows = RowsAt(base, found, score);
  Curve curve;
  double all = 0.0;
  for (const Rows& each : rows) all += each.weights.dot(each.effect.cwiseAbs2());
  std::vector<std::string> variables = VariablesOf(found.campaign().scene());
  const std::string own = OwnVariable(score.candidate.object);
  std::stable_partition(variables.begin(), variables.end(),
                        [&](const std::string& each) { return each == own; });
  Parted best;
  for (const std::string& variable : variables) {
    Parted parted = PartedBy(variable, found, rows);
    if (!(parted.kept > kKept * all) || !(parted.kept > kClearly * best.kept)) continue;
    best = std::move(parted);
    curve.variable = variable;
  }
  if (best.parts.empty()) return curve;
  curve.variable_unit = UnitOf(curve.variable);
  curve.unit = UnitAt(score, found.TraceOf(rows.front().run));
  std::sort(best.parts.begin(), best.parts.end(),
            [](const Part& a, const Part& b) { return a.at / a.weight < b.at / b.weight; });
  const Index count = best.parts.size();
  for (VectorXd* values : {&curve.at, &curve.before, &curve.after}) values->resize(count);
  for (Index i = 0; i < count; ++i) {
    const Part& part = best.parts[i];
    curve.at[i] = part.at / part.weight;
    curve.before[i] = part.before / part.weight;
    curve.after[i] = part.after / part.weight;
  }
  return curve;
}

double MapChange(const Fit& base, const Fit& found) {
  constexpr int kPlaces = 5;  // along each axis
  const Campaign& campaign = found.campaign();
  if (!campaign.instruments().HasAxes() || simulation::AxesOf(campaign.scene()).empty()) return 0.0;
  std::array<machine::VolumetricModel, 2> models{campaign.model(), campaign.model()};
  models[0].SetParameters(fusion::ValuesFound(base.result(), models[0].Blocks()));
  models[1].SetParameters(fusion::ValuesFound(found.result(), models[1].Blocks()));
  const auto& mill = campaign.instruments().machine;
  double most = 0.0;
  for (int place = 0; place < kPlaces * kPlaces * kPlaces; ++place) {
    Eigen::Vector3d axes;
    for (int axis = 0, rest = place; axis < 3; ++axis, rest /= kPlaces) {
      const auto& travel = mill.travels[axis];
      axes[axis] = travel.first + (travel.last - travel.first) * (rest % kPlaces) / (kPlaces - 1);
    }
    std::array<Eigen::Vector3d, 2> errors;
    for (std::size_t i = 0; i < models.size(); ++i) {
      errors[i] = machine::VolumetricErrorAndJacobian(models[i].chain(), axes, -mill.reference,
                                                      models[i].Motions(axes))
                      .error;
    }
    most = std::max(most, (errors[1] - errors[0]).norm());
  }
  return most;
}

}  // namespace abbe::diagnosis
