#include "diagnosis/structure_search.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <numbers>
#include <utility>

#include "diagnosis/scan.h"
#include "diagnosis/structure_refinement.h"
#include "estimation/in_parallel.h"
#include "simulation/variables.h"

namespace abbe::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using simulation::PeriodicVariablesOf;
using simulation::ProductsOf;
using simulation::Trace;
using simulation::ValuesOf;
using simulation::VariablesOf;

// What is left of the rows of all runs, for each channel that they tell of.
using ScoresByRun = std::vector<std::map<Index, Fit::RowScores>>;

ScoresByRun ScoresOf(const Fit& fit, const std::vector<std::vector<Structure>>& of_channel) {
  ScoresByRun all(fit.runs());
  for (std::size_t run = 0; run < fit.runs(); ++run) {
    const Trace& trace = fit.TraceOf(run);
    if (trace.rows() == 0) continue;
    for (const auto& structures : of_channel) {
      const StageChannel& channel = structures.front().channel;
      if (channel.Feels(trace)) all[run][channel.stage] = fit.ScoresOf(run, channel.stage);
    }
  }
  return all;
}

Scan ScanOf(const Fit& fit, const std::string& variable, const std::vector<StageChannel>& channels,
            const ScoresByRun& scores) {
  const auto count = static_cast<Index>(channels.size());
  Scan scan{{}, MatrixXd(count, 0), MatrixXd(count, 0)};
  for (std::size_t run = 0; run < fit.runs(); ++run) {
    const Trace& trace = fit.TraceOf(run);
    if (trace.rows() == 0 || !channels.back().Feels(trace)) continue;
    const RowVectorXd own = ValuesOf(variable, trace);
    if (own.size() == 0) continue;
    for (MatrixXd* matrix : {&scan.scores, &scan.weights}) {
      matrix->conservativeResize(Eigen::NoChange, matrix->cols() + own.size());
    }
    scan.values.conservativeResize(scan.values.size() + own.size());
    scan.values.tail(own.size()) = own;
    for (Index c = 0; c < count; ++c) {
      const auto& of_run = scores[run].at(channels[static_cast<std::size_t>(c)].stage);
      scan.scores.row(c).tail(own.size()) = of_run.scores;
      scan.weights.row(c).tail(own.size()) = of_run.weights;
    }
  }
  return scan;
}

// The strongest line and the strongest interval of each channel, to be asked as they should be.
// Channels of one kind of run share range and waves.
std::vector<std::vector<Structure>> StrongestOf(
    const Fit& fit, const simulation::Scene& scene, const std::string& variable,
    const ScoresByRun& scores, const std::vector<std::vector<Structure>>& of_channel) {
  std::vector<std::vector<Structure>> strongest(of_channel.size());
  for (const Instrument instrument : {kFeltByProbes, kFeltByLinkage, kFeltAtRim}) {
    std::vector<StageChannel> channels;
    std::vector<std::size_t> places;
    for (std::size_t c = 0; c < of_channel.size(); ++c) {
      StageChannel channel = of_channel[c].front().channel;
      if ((channel.instruments & instrument) == 0) continue;
      channel.instruments = instrument;
      channels.push_back(channel);
      places.push_back(c);
    }
    if (channels.empty()) continue;
    const auto found = RangeOf(variable, of_channel[places.back()].front().channel, scene);
    if (!found) continue;
    const Range range = *found;
    const Scan scan = ScanOf(fit, variable, channels, scores);
    const std::vector<double> waves =
        StrongestWaves(scan, 2.0 * std::numbers::pi * kOfAWave / range.Length());
    const std::vector<Interval> intervals = StrongestIntervals(scan);
    for (std::size_t c = 0; c < channels.size(); ++c) {
      const StageChannel& channel = of_channel[places[c]].front().channel;
      if (waves[c] > 0.0) {
        strongest[places[c]].push_back({.channel = channel,
                                        .variable = variable,
                                        .range = range,
                                        .form = Structure::Form::kLine,
                                        .wave = waves[c]});
      }
      if (!intervals[c].IsEmpty()) {
        strongest[places[c]].push_back({.channel = channel,
                                        .variable = variable,
                                        .range = range,
                                        .form = Structure::Form::kInterval,
                                        .interval = intervals[c]});
      }
    }
  }
  return strongest;
}

void AddStrongest(const Fit& fit, const simulation::Scene& scene,
                  std::vector<std::vector<Structure>>& of_channel) {
  const ScoresByRun scores = ScoresOf(fit, of_channel);
  const std::vector<std::string> variables = PeriodicVariablesOf(scene);
  std::vector<std::vector<std::vector<Structure>>> of_variable(variables.size());
  estimation::InParallel(variables.size(), [&](std::size_t v) {
    of_variable[v] = StrongestOf(fit, scene, variables[v], scores, of_channel);
  });
  for (const auto& strongest : of_variable) {
    for (std::size_t c = 0; c < of_channel.size(); ++c) {
      of_channel[c].insert(of_channel[c].end(), strongest[c].begin(), strongest[c].end());
    }
  }
}

}  // namespace

std::vector<Found> FindStructures(const Fit& fit) {
  const simulation::Scene scene = fit.campaign().scene();
  std::vector<std::vector<Structure>> of_channel;
  for (const StageChannel& channel : ChannelsOf(scene)) {
    std::vector<Structure> structures;
    for (const std::string& variable : VariablesOf(scene)) {
      if (const auto range = RangeOf(variable, channel, scene)) {
        structures.push_back(SmoothIn(channel, variable, *range));
      }
    }
    for (const std::string& product : ProductsOf(scene)) {
      const auto [one, other] = FactorsOf(product);
      const auto range = RangeOf(one, channel, scene), second = RangeOf(other, channel, scene);
      if (!range || !second) continue;
      structures.push_back({.channel = channel,
                            .variable = product,
                            .range = *range,
                            .form = Structure::Form::kProduct,
                            .second = *second});
    }
    if (!structures.empty()) of_channel.push_back(std::move(structures));
  }
  AddStrongest(fit, scene, of_channel);
  StructureQuestions questions(fit);
  std::vector<std::vector<Found>> found(of_channel.size());
  estimation::InParallel(of_channel.size(),
                         [&](std::size_t c) { found[c] = questions.Ask(of_channel[c]); });
  std::vector<Found> all;
  for (auto& of_one : found) std::move(of_one.begin(), of_one.end(), std::back_inserter(all));
  std::sort(all.begin(), all.end(),
            [](const Found& a, const Found& b) { return a.log_probability < b.log_probability; });
  return all;
}

}  // namespace abbe::diagnosis
