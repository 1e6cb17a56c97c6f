#include "diagnosis/structure_search.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <mutex>
#include <numbers>
#include <tuple>
#include <utility>

#include "estimation/in_parallel.h"
#include "simulation/variables.h"
#include "standards/chi_squared.h"

namespace abbe::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;
using simulation::IsGap;
using simulation::PeriodicVariablesOf;
using simulation::ProductsOf;
using simulation::Trace;
using simulation::ValuesOf;
using simulation::VariablesOf;

constexpr double kAbsorbed = 1e-4;  // of the most information: what is left is rounding
constexpr double kOfAWave = 0.4;    // over the range, from one line to the next
// Standard deviations that coefficients may have, m or rad.
constexpr SizeRange kSizes{1e-9, 1e-3, 1.25};

// Natural logarithm of the probability of so much by chance.
double LogChance(double chi_square, int freedom) {
  if (freedom == 0) return 0.0;
  const double one = standards::ChiSquaredExceeds(chi_square, freedom);
  return one > 0.0 ? std::log(one) : -0.5 * chi_square;
}

}  // namespace

Found Explained(Structure structure, const Fit::Projection& projection) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(projection.information);
  const double most = eigen.eigenvalues().maxCoeff();
  Found found{.structure = std::move(structure)};
  VectorXd coefficients = VectorXd::Zero(projection.score.size());
  for (Index i = 0; i < coefficients.size(); ++i) {
    const double value = eigen.eigenvalues()[i];
    if (!(value > kAbsorbed * most) || value <= 0.0) continue;
    const double along = eigen.eigenvectors().col(i).dot(projection.score);
    found.chi_square += along * along / value;
    coefficients += along / value * eigen.eigenvectors().col(i);
    ++found.freedom;
  }
  found.length = coefficients.cwiseProduct(found.structure.Weights()).norm();
  if (!found.structure.channel.IsPlausible(found.length)) {
    found.chi_square = 0.0;
    found.freedom = 0;
    return found;
  }
  const double among = std::log(found.structure.among());
  found.log_probability = std::min(0.0, LogChance(found.chi_square, found.freedom) + among);
  found.drawn = SizeOfDraws(projection, kSizes, 0.0);
  found.drawn.log_evidence -= among;
  return found;
}

namespace {

// Functions of the rows of runs, made once for all channels that are asked of them. Lines and
// intervals are each channel's own. Safe to share between threads.
class SharedFunctions {
 public:
  explicit SharedFunctions(const Fit& fit) : fit_(fit) {}

  static bool Has(const Structure& structure) {
    using Form = Structure::Form;
    return structure.form != Form::kLine && structure.form != Form::kInterval;
  }

  // One row for each term; no rows: the run does not have the variable.
  const MatrixXd& Of(std::size_t run, const Structure& structure) {
    const Key key{run,
                  structure.variable,
                  structure.range.first,
                  structure.range.last,
                  structure.second.first,
                  structure.second.last,
                  structure.terms,
                  structure.from,
                  structure.is_rough};
    if (const MatrixXd* known = Known(key)) return *known;
    MatrixXd functions = structure.FunctionsOf(fit_.TraceOf(run));
    const std::lock_guard lock(mutex_);
    return known_.try_emplace(key, std::move(functions)).first->second;
  }

 private:
  using Key =
      std::tuple<std::size_t, std::string, double, double, double, double, Index, Index, bool>;

  const MatrixXd* Known(const Key& key) {
    const std::lock_guard lock(mutex_);
    const auto found = known_.find(key);
    return found == known_.end() ? nullptr : &found->second;
  }

  const Fit& fit_;
  std::mutex mutex_;
  std::map<Key, MatrixXd> known_;
};

// Structures of one channel, which share its stage.
std::vector<Found> Ask(const Fit& fit, const std::vector<Structure>& structures,
                       SharedFunctions& shared) {
  std::vector<Index> groups;
  groups.reserve(structures.size());
  Index columns = 0;
  for (const Structure& structure : structures) {
    groups.push_back(structure.columns());
    columns += groups.back();
  }
  const StageChannel& channel = structures.front().channel;
  std::vector<MatrixXd> functions(fit.runs());
  for (std::size_t run = 0; run < fit.runs(); ++run) {
    const Trace& trace = fit.TraceOf(run);
    if (trace.rows() == 0 || !channel.Feels(trace)) continue;
    functions[run] = MatrixXd::Zero(columns, trace.rows());
    Index first = 0;
    for (std::size_t s = 0; s < structures.size(); ++s) {
      MatrixXd made;
      const MatrixXd& own = SharedFunctions::Has(structures[s])
                                ? shared.Of(run, structures[s])
                                : (made = structures[s].FunctionsOf(trace));
      if (own.rows() > 0) functions[run].middleRows(first, own.rows()) = own;
      first += groups[s];
    }
  }
  const auto projections = fit.ProjectInStage(channel.stage, functions, groups);
  std::vector<Found> found;
  for (std::size_t s = 0; s < structures.size(); ++s) {
    found.push_back(Explained(structures[s], projections[s]));
  }
  return found;
}

std::vector<Found> Ask(const Fit& fit, const std::vector<Structure>& structures) {
  SharedFunctions shared(fit);
  return Ask(fit, structures, shared);
}

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

// The scan does not know what else may take in a part of an effect, and stops at an edge of it:
// moves the borders as long as more is explained.
Found Sharpened(const Fit& fit, Found found) {
  const Range range = found.structure.range;
  const double cell = range.Length() / kLines;
  const double end = std::nextafter(range.last, std::numeric_limits<double>::infinity());
  for (bool better = true; better;) {
    const auto [from, to] = found.structure.interval;
    std::vector<Structure> others;
    const auto add = [&](Interval interval) {
      interval.from = std::max(interval.from, range.first);
      interval.to = std::min(interval.to, end);
      if (interval.to - interval.from < 0.5 * cell) return;
      others.push_back(found.structure);
      others.back().interval = interval;
    };
    for (Index cells = 1; cells < kLines; cells *= 2) {
      const double step = cell * cells;
      add({from - step, to});
      add({from + step, to});
      add({from, to - step});
      add({from, to + step});
      add({from - step, from});
      add({to, to + step});
    }
    // On the way there and back the simulation sees differences: its mirror does nearly the same.
    add({from - (to - from), from});
    add({to, to + (to - from)});
    better = false;
    for (Found& other : Ask(fit, others)) {
      if (other.chi_square <= found.chi_square) continue;
      found = std::move(other);
      better = true;
    }
  }
  return found;
}

// Where it turns evenly, tuned waves are the harmonics that causes make.
bool IsAtShaft(const Found& found) { return found.structure.channel.instruments == kFeltAtRim; }

// A smooth function with as many terms as the data ask for. What a probe makes of its own gap has
// no fine structure: along an axis the gap goes with the position, and many terms would do what two
// swapped cables do.
Found Finest(const Fit& fit, Found found) {
  constexpr Index kMostTerms = 64;
  const Index most = IsGap(found.structure.variable) ? found.structure.terms : kMostTerms;
  for (Index terms = 2 * found.structure.terms; terms <= most; terms *= 2) {
    std::vector<Structure> finer(2, found.structure);
    for (Structure& each : finer) each.terms = terms;
    finer.back().is_rough = true;
    bool better = false;
    for (Found& other : Ask(fit, finer)) {
      if (other.drawn.log_evidence <= found.drawn.log_evidence) continue;
      found = std::move(other);
      better = true;
    }
    if (!better) break;
  }
  return found;
}

// The wave between those that were tried, to a thousandth of the step between them.
Found Tuned(const Fit& fit, Found found) {
  constexpr int kLevels = 5, kTried = 4;  // on both sides
  double step = 2.0 * std::numbers::pi * kOfAWave / found.structure.range.Length() / kTried;
  for (int level = 0; level < kLevels; ++level, step /= kTried) {
    std::vector<Structure> others;
    for (int i = -kTried; i <= kTried; ++i) {
      const double wave = found.structure.wave + i * step;
      if (i == 0 || wave <= 0.0) continue;
      others.push_back(found.structure);
      others.back().wave = wave;
    }
    for (Found& other : Ask(fit, others)) {
      if (other.chi_square > found.chi_square) found = std::move(other);
    }
  }
  return found;
}

// The explained part, over the rows of a shaft. Where it turns evenly, time and the harmonics that
// are known go together, and the coefficients of the answer are larger than what they do.
double RmsOf(const Fit& fit, const Found& found) {
  double weight = 0.0;
  for (std::size_t run = 0; run < fit.runs(); ++run) {
    if (InstrumentOf(fit.TraceOf(run)) != kFeltAtRim) continue;
    weight += fit.ScoresOf(run, found.structure.channel.stage).weights.sum();
  }
  return std::sqrt(found.chi_square / weight);
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
  SharedFunctions shared(fit);
  std::vector<std::vector<Found>> found(of_channel.size());
  estimation::InParallel(of_channel.size(),
                         [&](std::size_t c) { found[c] = Ask(fit, of_channel[c], shared); });
  std::vector<Found> all;
  for (auto& of_one : found) std::move(of_one.begin(), of_one.end(), std::back_inserter(all));
  std::sort(all.begin(), all.end(),
            [](const Found& a, const Found& b) { return a.log_probability < b.log_probability; });
  return all;
}

void AddAlike(const Structure& other, Found& found) {
  const Dependence own{found.structure.variable, found.structure.channel.object},
      more{other.variable, other.channel.object};
  const bool known = std::ranges::find(found.one_of, more) != found.one_of.end();
  if (more != own && !known) found.one_of.push_back(more);
}

Found Asked(const Fit& fit, const Structure& structure) { return Ask(fit, {structure}).front(); }

Found Refined(const Fit& fit, Found found) {
  if (found.structure.form == Structure::Form::kInterval) return Sharpened(fit, std::move(found));
  if (found.structure.form == Structure::Form::kSmooth) return Finest(fit, std::move(found));
  if (found.structure.form == Structure::Form::kLine && !IsAtShaft(found)) {
    return Tuned(fit, std::move(found));
  }
  return found;
}

Leftover LeftoverOf(const Fit& fit, const Found& found, std::size_t questions) {
  const Structure& structure = found.structure;
  const double amplitude = structure.channel.instruments == kFeltAtRim ? RmsOf(fit, found)
                           : structure.interval.IsEmpty() ? found.length / std::numbers::sqrt2
                                                          : found.length;
  return {structure.variable,
          structure.channel.object,
          amplitude,
          structure.channel.unit,
          std::min(1.0, std::exp(found.log_probability) * questions),
          structure.wave > 0.0 ? 2.0 * std::numbers::pi / structure.wave : 0.0,
          structure.interval.from,
          structure.interval.to,
          found.one_of};
}

std::vector<Leftover> LeftoversOf(const Fit& fit, const std::vector<Found>& found) {
  constexpr std::size_t kMostTold = 6;  // what one stage does, the others see too
  std::vector<Leftover> leftovers;
  for (const Found& each : found) {
    const auto same = [&](const Leftover& other) {
      return other.object == each.structure.channel.object;
    };
    if (std::any_of(leftovers.begin(), leftovers.end(), same)) continue;
    if (LeftoverOf(fit, each, found.size()).p_value >= kDoubt) break;
    if (leftovers.size() == kMostTold) break;
    const bool interval = each.structure.form == Structure::Form::kInterval;
    Found strongest = interval ? Sharpened(fit, each) : each;
    for (const Found& other : found) {
      const bool alike = other.structure.channel.object == each.structure.channel.object &&
                         other.log_probability < strongest.log_probability + kAsGood;
      if (alike) AddAlike(other.structure, strongest);
    }
    leftovers.push_back(LeftoverOf(fit, strongest, found.size()));
  }
  return leftovers;
}

}  // namespace abbe::diagnosis
