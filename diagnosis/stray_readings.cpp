#include "diagnosis/stray_readings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>

#include "diagnosis/invalid_readings.h"
#include "machine/machine.h"
#include "simulation/stage_channel.h"

namespace abbe::diagnosis {
namespace {

using Eigen::Index;
using Eigen::RowVectorXd;
using Eigen::VectorXd;
using simulation::StageChannel;
using simulation::Trace;

constexpr double kAtPeace = 4.0;                // standard deviations
constexpr double kAhead = kAtPeace * kAtPeace;  // of chi-square
constexpr double kOften = 0.1;                  // of the turns of an axis: more, and it jumps there
constexpr Index kReadingsOfAStray = 50;         // of a run, at least

// Standard deviations by which each row of a channel is off; empty where the run does not tell.
RowVectorXd OffOf(const Fit& fit, std::size_t run, const StageChannel& channel) {
  const Fit::RowScores rows = fit.ScoresOf(run, channel.stage);
  if (rows.scores.size() == 0 || rows.weights.size() == 0) return {};
  return (rows.weights.array() > 0.0)
      .select(rows.scores.array() / rows.weights.array().max(1e-300).sqrt(), 0.0);
}

bool IsOneReading(const Trace& trace, Index row) {
  return trace.samples.size() == 0 || trace.samples[row] == 1.0;
}

struct Suspect {
  std::size_t run;
  Index row;
};

std::vector<StageChannel> ChannelsOf(const Trace& trace) {
  // Without travels: what the instrument reads.
  return simulation::ChannelsOf({.traces = {&trace}, .travel = Eigen::Vector3d::Zero()});
}

// The readings of a run that are off by themselves.
std::vector<Suspect> AloneIn(const Fit& fit, std::size_t run) {
  const Trace& trace = fit.TraceOf(run);
  RowVectorXd largest = RowVectorXd::Zero(trace.rows());
  for (const StageChannel& channel : ChannelsOf(trace)) {
    if (!channel.Feels(trace)) continue;
    const RowVectorXd off = OffOf(fit, run, channel);
    if (off.size() > 0) largest = largest.cwiseMax(off.cwiseAbs());
  }
  const auto at_peace = [&](Index row) {
    return row < 0 || row >= largest.size() || largest[row] < kAtPeace;
  };
  std::vector<Suspect> alone;
  for (Index row = 0; row < largest.size(); ++row) {
    if (largest[row] < kFar || !at_peace(row - 1) || !at_peace(row + 1)) continue;
    if (IsOneReading(trace, row)) alone.push_back({run, row});
  }
  const bool too_many = std::ssize(alone) > std::max<Index>(1, trace.rows() / kReadingsOfAStray);
  return too_many ? std::vector<Suspect>{} : alone;
}

// What could be off in one reading: each channel of the instrument, or the place of an axis.
std::vector<Index> StagesOf(const Trace& trace) {
  std::vector<Index> stages;
  for (const StageChannel& channel : ChannelsOf(trace)) stages.push_back(channel.stage);
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    stages.push_back(simulation::MotionStage(axis, axis));
  }
  return stages;
}

std::vector<Fit::Projection> ProjectionsOf(const Fit& fit, const std::vector<Suspect>& suspects) {
  std::vector<Index> groups;
  groups.reserve(suspects.size());
  for (const Suspect& each : suspects)
    groups.push_back(std::ssize(StagesOf(fit.TraceOf(each.run))));
  const auto one_row_each = [&](const Trace& of_run) {
    std::vector<simulation::Disturbance> all;
    for (const Suspect& each : suspects) {
      const Trace& trace = fit.TraceOf(each.run);
      for (const Index stage : StagesOf(trace)) {
        all.push_back(simulation::NoDisturbance(of_run));
        if (trace.name == of_run.name) all.back().row(stage)[each.row] = 1.0;
      }
    }
    return all;
  };
  return fit.Project(one_row_each, groups);
}

void Add(const std::string& run, const std::string& object, double time,
         std::vector<StrayReadings>& strays) {
  const auto known = std::ranges::find_if(strays, [&](const StrayReadings& other) {
    return other.run == run && other.object == object;
  });
  (known != strays.end() ? *known : strays.emplace_back(StrayReadings{run, object, {}}))
      .times.push_back(time);
}

// Whether an axis turns there.
bool Turns(const Trace& trace, Index row, int axis) {
  const auto heading = trace.heading.row(axis);
  return row > 0 && heading[row - 1] * heading[row] < 0.0;
}

bool TurnsNear(const Trace& trace, Index row, int axis) {
  return Turns(trace, row, axis) || (row + 1 < trace.rows() && Turns(trace, row + 1, axis));
}

// What an error of each stage alone would account for, of chi-square.
VectorXd ExplainedAlone(const Fit::Projection& projection) {
  const VectorXd information = projection.information.diagonal();
  return (information.array() > 0.0)
      .select(projection.score.array().square() / information.array().max(1e-300), 0.0);
}

// How many suspects an axis accounts for as well as any channel does where it turns, of its turns.
double ShareOfTurns(const Fit& fit, const std::vector<Suspect>& suspects,
                    const std::vector<VectorXd>& explained, int axis) {
  double turns = 1.0, of_axis = 0.0;
  for (std::size_t run = 0; run < fit.runs(); ++run) {
    const Trace& trace = fit.TraceOf(run);
    for (Index row = 0; row < trace.rows(); ++row) turns += Turns(trace, row, axis) ? 1.0 : 0.0;
  }
  for (std::size_t i = 0; i < suspects.size(); ++i) {
    const double by_axis = explained[i].tail<machine::kAxes>()[axis];
    if (by_axis < explained[i].maxCoeff() - kAhead) continue;
    of_axis += TurnsNear(fit.TraceOf(suspects[i].run), suspects[i].row, axis) ? 1.0 : 0.0;
  }
  return of_axis / turns;
}

// The channel that accounts for a reading by itself: all of it, and better than any other.
std::optional<Index> ChannelOf(const Fit::Projection& projection, const VectorXd& explained) {
  const Index count = explained.size() - machine::kAxes;
  const VectorXd score = projection.score.head(count);
  const Eigen::MatrixXd S = projection.information.topLeftCorner(count, count);
  Index best = 0;
  const double most = explained.head(count).maxCoeff(&best);
  for (Index other = 0; other < count; ++other) {
    if (other != best && most - explained[other] < kAhead) return {};
  }
  const double all = score.dot(S.completeOrthogonalDecomposition().solve(score));
  if (all - most > kAhead || explained.maxCoeff() - most > kAhead) return {};
  return best;
}

}  // namespace

std::vector<StrayReadings> StrayReadingsOf(const Fit& fit) {
  std::vector<Suspect> suspects;
  for (std::size_t run = 0; run < fit.runs(); ++run) {
    std::ranges::copy(AloneIn(fit, run), std::back_inserter(suspects));
  }
  if (suspects.empty()) return {};
  const std::vector<Fit::Projection> projections = ProjectionsOf(fit, suspects);
  std::vector<VectorXd> explained(suspects.size());
  std::ranges::transform(projections, explained.begin(), ExplainedAlone);
  std::array<bool, machine::kAxes> jumps{};
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    jumps[axis] = ShareOfTurns(fit, suspects, explained, axis) > kOften;
  }
  std::vector<StrayReadings> strays;
  for (std::size_t i = 0; i < suspects.size(); ++i) {
    const std::size_t run = suspects[i].run;
    const Index row = suspects[i].row;
    const Trace& trace = fit.TraceOf(run);
    const auto channel = ChannelOf(projections[i], explained[i]);
    const auto may_be_axis = [&](int axis) { return jumps[axis] && TurnsNear(trace, row, axis); };
    if (!channel || may_be_axis(0) || may_be_axis(1) || may_be_axis(2)) continue;
    Add(trace.name, ChannelsOf(trace)[*channel].object, trace.time[row], strays);
  }
  return strays;
}

}  // namespace abbe::diagnosis
