#include "fusion/circle_causes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <utility>

#include "failure/failure.h"
#include "fusion/circle_fit.h"
#include "standards/circle_signatures.h"
#include "standards/coverage.h"
#include "standards/student_coverage.h"

namespace abbe::fusion {
namespace {

using paths::CirclePoint;
using paths::CircleRun;
using standards::Signature;

constexpr std::size_t kSectors = 36;  // their means show the correlation of neighbouring rows
// m: the first guess of the noise, below that of any instrument of a machine shop and so small that
// the priors have no effect.
constexpr double kLeastRadialNoise = 10e-9;
constexpr double kSameRadius = 0.01;      // of the radius: lag makes a fast circle smaller
constexpr double kLargePart = 0.3;        // of a weak direction of length 1
constexpr double kRowsOfParameter = 1.5;  // at least
constexpr double kLeastFreedom = 3.0;     // rows beyond the causes and centres

void CheckCircles(const std::vector<const CircleRun*>& runs) {
  if (runs.empty()) throw InputError("no circle to find the causes of");
  for (const CircleRun* run : runs) {
    if (run->plane.Inclined()) {
      throw InputError(fmt::format(
          "{}: the circle lies in no plane of two axes: its causes cannot be assigned to axes",
          run->recordings.front()));
    }
    if (run->plane.name != runs.front()->plane.name ||
        run->instrument != runs.front()->instrument ||
        std::abs(run->radius - runs.front()->radius) > kSameRadius * run->radius) {
      throw InputError(
          fmt::format("{} and {}: circles of another plane, radius or instrument: fit each alone",
                      runs.front()->recordings.front(), run->recordings.front()));
    }
  }
}

Eigen::Index Rows(const std::vector<const CircleRun*>& runs) {
  Eigen::Index rows = 0;
  for (const CircleRun* run : runs) rows += std::ssize(run->points);
  return rows;
}

// The orders of smooth errors that so many points can show beside the causes and the centres.
void LimitOrders(const std::vector<const CircleRun*>& runs, std::size_t causes,
                 std::vector<double>& smooth) {
  const double rows = static_cast<double>(Rows(runs));
  const double named = static_cast<double>(causes + 2 * runs.size());
  if (rows < named + kLeastFreedom) {
    throw InputError(
        fmt::format("{}: {} points for the {} causes and centres of a circle; measure {} at least, "
                    "better a point every few degrees",
                    runs.front()->recordings.front(), rows, named, named + kLeastFreedom));
  }
  while (!smooth.empty() &&
         rows < kRowsOfParameter * (named + 2.0 * static_cast<double>(smooth.size()))) {
    smooth.pop_back();
  }
}

double Rms(const std::vector<Eigen::VectorXd>& residuals) {
  double squares = 0.0, n = 0.0;
  for (const Eigen::VectorXd& one : residuals) {
    squares += one.squaredNorm();
    n += one.size();
  }
  return std::sqrt(squares / n);
}

// Rows less the parameters that the data determine: 1 at least.
double FreedomOf(const CircleFit& fit, double rows) {
  return std::clamp(fit.result.redundancy, 1.0, rows);
}

// The factor by which the means of sectors scatter more than those of independent rows: at least 1.
double Correlated(const std::vector<const CircleRun*>& runs,
                  const std::vector<Eigen::VectorXd>& residuals, double rms) {
  double excess = 0.0, sectors = 0.0;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    std::array<std::array<double, kSectors>, 2> sums{}, counts{};
    for (std::size_t i = 0; i < runs[r]->points.size(); ++i) {
      const CirclePoint& point = runs[r]->points[i];
      const double part = point.angle / (2 * std::numbers::pi) + 0.5;
      const std::size_t sector =
          std::min(kSectors - 1, static_cast<std::size_t>(std::max(0.0, part) * kSectors));
      const std::size_t sense = point.sense > 0 ? 1 : 0;
      sums[sense][sector] += residuals[r][i];
      counts[sense][sector] += 1.0;
    }
    for (std::size_t sense = 0; sense < 2; ++sense) {
      for (std::size_t k = 0; k < kSectors; ++k) {
        if (counts[sense][k] == 0.0) continue;
        excess += sums[sense][k] * sums[sense][k] / counts[sense][k];
        sectors += 1.0;
      }
    }
  }
  return rms > 0.0 ? std::sqrt(std::max(1.0, excess / sectors / (rms * rms))) : 1.0;
}

// By the median of second differences, which leaves out what goes on from point to point, and the
// few points of a spike.
double BeyondNoise(const std::vector<Eigen::VectorXd>& residuals, double rms) {
  constexpr double kMedian = 0.6745;  // of a normal number without its sign
  std::vector<double> differences;
  for (const Eigen::VectorXd& one : residuals) {
    for (Eigen::Index i = 1; i + 1 < one.size(); ++i) {
      differences.push_back(std::abs(one[i - 1] - 2.0 * one[i] + one[i + 1]) / std::sqrt(6.0));
    }
  }
  if (differences.empty()) return 1.0;
  const auto middle = differences.begin() + std::ssize(differences) / 2;
  std::nth_element(differences.begin(), middle, differences.end());
  return rms / std::max(*middle / kMedian, kLeastRadialNoise);
}

// The data determine the parameter itself, not only a combination with another.
bool SeenByData(const estimation::Result& result, const std::string& name) {
  if (result.Seen(name) != estimation::SeenBy::kData) return false;
  const auto at = std::ranges::find(result.names, name) - result.names.begin();
  return std::ranges::none_of(result.weak_directions, [&](const estimation::WeakDirection& weak) {
    return std::abs(weak.coefficients[at]) > kLargePart;
  });
}

// The largest coefficient is that of a cause; directions of the nuisance parameters are of no
// interest.
bool IsOfCauses(const estimation::Result& result, const estimation::WeakDirection& weak) {
  Eigen::Index most = 0;
  weak.coefficients.cwiseAbs().maxCoeff(&most);
  return result.names[most].starts_with("cause.");
}

// A fit and the form it was made with.
struct CircleTrial {
  ReversalForm form;
  CircleCauses found;
  std::array<double, 2> longer{}, wider{};  // CircleFit
  double improbable = 0.0;
};

// Where spikes have a form of their own, the size of one is the height of the whole, the same part of
// all runs: the largest of its deviations.
void TakeWholeSpikes(const CircleFit& fit, const CircleEquations& grid,
                     const std::vector<Signature>& table, CircleCauses& found) {
  const auto causes = std::ssize(table);
  const Eigen::Index of_axis = grid.alike.cols() / 2, all = causes + grid.alike.cols();
  Eigen::VectorXd parameters(all);
  parameters << fit.result.Block("cause").Values(), fit.result.Block("alike").Values();
  Eigen::MatrixXd covariance(all, all);
  const Eigen::MatrixXd across = fit.result.Covariance("cause", "alike");
  covariance << fit.result.Covariance("cause", "cause"), across, across.transpose(),
      fit.result.Covariance("alike", "alike");
  Eigen::MatrixXd of_parameters = Eigen::MatrixXd::Identity(causes, all);
  Eigen::Index axis = 0;
  for (Eigen::Index cause = 0; cause < causes; ++cause) {
    if (table[cause].cause != "reversal_spike") continue;
    Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(grid.causes.rows(), all);
    whole.col(cause) = grid.causes.col(cause);
    const Eigen::Index first = of_axis * axis++;
    whole.middleCols(causes + first, of_axis) = grid.alike.middleCols(first, of_axis);
    const Eigen::VectorXd deviation = whole * parameters;
    Eigen::Index highest = 0;
    deviation.cwiseAbs().maxCoeff(&highest);
    of_parameters.row(cause) = whole.row(highest);
  }
  found.covariance = of_parameters * covariance * of_parameters.transpose();
  const Eigen::VectorXd values = of_parameters * parameters;
  for (Eigen::Index cause = 0; cause < causes; ++cause) {
    found.causes[cause].value = values[cause];
    found.causes[cause].u = std::sqrt(found.covariance(cause, cause));
  }
}

CircleTrial FitWith(const std::vector<const CircleRun*>& runs, const CauseOptions& options,
                    const ReversalForm& form) {
  const std::vector<Signature> table = CausesOf(*runs.front(), options, form);
  std::vector<CircleEquations> equations;
  CircleCauses found;
  std::vector<Eigen::VectorXd> before;
  for (std::size_t run = 0; run < runs.size(); ++run) {
    equations.push_back(CentredEquations(runs, run, options, form));
    const Eigen::VectorXd& radial = equations.back().radial;
    before.emplace_back(radial.array() - radial.mean());
  }
  found.rms_before = Rms(before);
  const CircleFit first = SolveCircles(equations, table, options, kLeastRadialNoise);
  const double rows = static_cast<double>(Rows(runs));
  const double rms =
      std::max(Rms(first.noise) * std::sqrt(rows / FreedomOf(first, rows)), kLeastRadialNoise);
  found.correlated = Correlated(runs, first.noise, rms);
  const CircleFit fit = SolveCircles(equations, table, options, rms * found.correlated);
  std::vector<Eigen::VectorXd> smooth;
  for (const Eigen::VectorXd& one : fit.smooth) smooth.emplace_back(one.array() - one.mean());
  found.rms_smooth = Rms(smooth);  // a longer ballbar is no error of the machine
  found.rms_after = Rms(fit.noise);
  found.beyond_noise = BeyondNoise(fit.noise, found.rms_after);
  found.covariance = fit.result.Covariance("cause", "cause");
  const double independent = rows / (found.correlated * found.correlated);
  found.freedom = std::max(independent - (rows - FreedomOf(fit, rows)), 1.0);
  for (std::size_t i = 0; i < table.size(); ++i) {
    const std::string name = "cause." + CauseName(table[i]);
    CauseEstimate estimate{table[i].cause, table[i].object, table[i].unit, fit.result.Value(name),
                           fit.result.Uncertainty(name)};
    for (const CircleEquations& one : equations) {
      estimate.effect = std::max(
          estimate.effect, std::abs(estimate.value) * one.causes.col(i).cwiseAbs().maxCoeff());
    }
    estimate.seen = SeenByData(fit.result, name);
    estimate.alike = table[i].alike;
    found.causes.push_back(std::move(estimate));
  }
  if (form.spike_size != std::array<double, 2>{}) {
    TakeWholeSpikes(fit, SpikesOnGrid(*runs.front(), options, form), table, found);
  }
  for (const auto& weak : fit.result.weak_directions) {
    if (IsOfCauses(fit.result, weak)) found.weak_directions.push_back(weak.words);
  }
  for (const Eigen::VectorXd& one : fit.unexplained) {
    found.residuals.emplace_back(one.begin(), one.end());
  }
  return {form, std::move(found), fit.longer, fit.wider, fit.improbable};
}

// Of both axes, with their signs.
std::array<double, 2> OfBothAxes(const std::string& cause, const CircleCauses& found) {
  std::array<double, 2> values{};
  std::size_t axis = 0;
  for (const CauseEstimate& one : found.causes) {
    if (one.cause == cause) values[axis++] = one.value;
  }
  return values;
}

const CircleTrial& MostLikely(const std::vector<CircleTrial>& trials) {
  return *std::ranges::min_element(trials, {},
                                   [](const CircleTrial& one) { return one.found.rms_after; });
}

// The spikes that are far beyond chance: of smaller ones the form does not matter.
std::array<double, 2> SpikesOf(const CircleCauses& found) {
  constexpr double kFarBeyond = 5.0;
  std::array<double, 2> spikes = OfBothAxes("reversal_spike", found);
  std::size_t axis = 0;
  for (const CauseEstimate& one : found.causes) {
    if (one.cause != "reversal_spike") continue;
    if (std::abs(one.value) <= kFarBeyond * one.u) spikes[axis] = 0.0;
    ++axis;
  }
  return spikes;
}

// The fit with the way of winding up and the width of spikes that suit each axis best, not known
// better than the fit tells them: a list would leave what rests on them as far off as its nearest
// entry.
CircleTrial WithOwnForm(const std::vector<const CircleRun*>& runs, const CauseOptions& options,
                        CircleTrial trial) {
  constexpr int kSteps = 12;
  constexpr double kFarthest = 0.5, kNear = 0.01;        // of a logarithm, in one step
  constexpr double kNarrowest = 0.005, kWidest = 0.3;    // rad
  constexpr double kShortest = 0.2e-6, kLongest = 8e-3;  // m
  for (int step = 0; step < kSteps; ++step) {
    ReversalForm form = trial.form;
    form.spread = SpikesOf(trial.found);
    if (form.how == standards::TakenUp::kByWindUp) {
      form.wound_up = OfBothAxes("backlash", trial.found);
    }
    double farthest = 0.0;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      double& way = form.way[axis];
      way *= std::exp(std::clamp(trial.longer[axis], -kFarthest, kFarthest));
      if (way > 0.0) way = std::clamp(way, kShortest, kLongest);
      double& width = form.spike.width[axis];
      width *= std::exp(std::clamp(trial.wider[axis], -kFarthest, kFarthest));
      width = std::clamp(width, kNarrowest, kWidest);
      farthest = std::max({farthest, std::abs(trial.longer[axis]), std::abs(trial.wider[axis])});
    }
    if (step > 1 && farthest < kNear) break;
    trial = FitWith(runs, options, form);
  }
  return trial;
}

// The fits with all ways in which backlash may be taken up, beside spikes of this form.
void FitTakenUp(const std::vector<const CircleRun*>& runs, const CauseOptions& options,
                const standards::SpikeForm& spike, std::vector<CircleTrial>& trials) {
  constexpr int kRounds = 4;  // each brings the way closer to the play by a factor of five
  constexpr std::array kWays{0.5e-6, 1e-6,   2e-6, 5e-6, 10e-6, 20e-6, 50e-6, 100e-6,
                             200e-6, 500e-6, 1e-3, 2e-3, 3e-3,  5e-3,  8e-3};  // m
  const auto fitted = [&](const ReversalForm& form) { return FitWith(runs, options, form); };
  ReversalForm form{.spike = spike};
  trials.push_back(fitted(form));
  CircleTrial with_play = trials.back();
  with_play.form.how = standards::TakenUp::kWithPlay;
  for (int round = 0; round < kRounds; ++round) {
    with_play.form.way = OfBothAxes("backlash", with_play.found);
    for (double& way : with_play.form.way) way = std::abs(way);
    with_play = fitted(with_play.form);
  }
  trials.push_back(std::move(with_play));
  form.how = standards::TakenUp::kByWindUp;
  for (const double way : kWays) {
    form.way = {way, way};
    trials.push_back(fitted(form));
  }
}

// Of each way in which backlash may be taken up, the best of `trials` with its own form.
void FitOwnForms(const std::vector<const CircleRun*>& runs, const CauseOptions& options,
                 std::vector<CircleTrial>& trials) {
  for (const auto how : {standards::TakenUp::kAtOnce, standards::TakenUp::kWithPlay,
                         standards::TakenUp::kByWindUp}) {
    std::vector<CircleTrial> of_kind;
    std::ranges::copy_if(trials, std::back_inserter(of_kind),
                         [&](const CircleTrial& trial) { return trial.form.how == how; });
    trials.push_back(WithOwnForm(runs, options, MostLikely(of_kind)));
  }
}

// The logarithm of the marginal likelihood of a fit, up to what is the same for all. `rows`:
// independent ones.
double LogLikelihood(const CircleTrial& trial, double rows) {
  return -rows * std::log(std::max(trial.found.rms_after, kLeastRadialNoise)) - trial.improbable;
}

double IndependentRows(const std::vector<const CircleRun*>& runs, const CircleCauses& fit) {
  return static_cast<double>(Rows(runs)) / (fit.correlated * fit.correlated);
}

Eigen::VectorXd ValuesOf(const CircleCauses& fit) {
  Eigen::VectorXd values(fit.causes.size());
  for (Eigen::Index i = 0; i < values.size(); ++i) values[i] = fit.causes[i].value;
  return values;
}

standards::SpikeForm StatedSpike(const CauseOptions& options) {
  return {.width = {options.spike_width, options.spike_width}};
}

// Rounded and sharp, as wide at all feeds or in proportion to them where there are several: in the
// angle, as friction has them that is overcome on a way, or in time, as controls have them.
std::vector<standards::SpikeForm> SpikesLike(const std::vector<const CircleRun*>& runs,
                                             const CauseOptions& options) {
  constexpr double kOtherFeed = 1.2;  // times the smallest
  const auto feed = [](const CircleRun* run) { return run->feed; };
  const double least = std::ranges::min(runs, {}, feed)->feed;
  const double most = std::ranges::max(runs, {}, feed)->feed;
  std::vector<standards::SpikeForm> forms;
  for (const bool sharp : {false, true}) {
    standards::SpikeForm form = StatedSpike(options);
    form.sharp = sharp;
    forms.push_back(form);
    form.at_feed = std::sqrt(least * most);
    if (least > 0.0 && most > kOtherFeed * least) forms.push_back(form);
  }
  return forms;
}

// Fits with spikes of this form of all widths, backlash taken up as it is in the best of `trials`,
// and with the width that suits each axis best.
void FitSpikes(const std::vector<const CircleRun*>& runs, const CauseOptions& options,
               const standards::SpikeForm& spike, std::vector<CircleTrial>& trials) {
  constexpr std::array kWidths{0.2, 0.3, 0.45, 0.67, 1.0, 1.5, 2.2, 3.3, 5.0};  // of that stated
  ReversalForm form = MostLikely(trials).form;
  form.wound_up = {};
  form.spread = {};
  std::vector<CircleTrial> of_form;
  for (const double times : kWidths) {
    form.spike = spike;
    for (double& width : form.spike.width) width *= times;
    of_form.push_back(FitWith(runs, options, form));
  }
  of_form.push_back(WithOwnForm(runs, options, MostLikely(of_form)));
  std::ranges::move(of_form, std::back_inserter(trials));
}

// The best of `trials` of each kind.
template <typename Kind>
std::vector<CircleTrial> BestOfEach(const std::vector<CircleTrial>& trials, const Kind& kind) {
  std::map<decltype(kind(trials.front())), CircleTrial> best;
  for (const CircleTrial& trial : trials) {
    const auto [at, added] = best.try_emplace(kind(trial), trial);
    if (!added && trial.found.rms_after < at->second.found.rms_after) at->second = trial;
  }
  std::vector<CircleTrial> values;
  for (auto& [key, trial] : best) values.push_back(std::move(trial));
  return values;
}

// Every way in which backlash may be taken up beside every form of spikes, which are not quite of
// that form. Without that the forms are not to be compared: one would take the part of another's.
std::vector<CircleTrial> WithFormsOfTheirOwn(const std::vector<const CircleRun*>& runs,
                                             const CauseOptions& options,
                                             const std::vector<CircleTrial>& trials) {
  const auto spikes = BestOfEach(trials, [](const CircleTrial& trial) {
    return std::pair(trial.form.spike.sharp, trial.form.spike.at_feed > 0.0);
  });
  const auto ways = BestOfEach(trials, [](const CircleTrial& trial) { return trial.form.how; });
  std::vector<CircleTrial> formed;
  for (const CircleTrial& spike : spikes) {
    for (const CircleTrial& way : ways) {
      ReversalForm form = way.form;
      form.spike = spike.form.spike;
      form.spike_size = form.spread = SpikesOf(spike.found);
      if (form.spike_size == std::array<double, 2>{}) continue;
      formed.push_back(FitWith(runs, options, form));
    }
  }
  return formed;
}

// Fits with all forms that a reversal may have: backlash taken up in every way and spikes of every
// form and width; where there are spikes, these not quite of the form of the table.
std::vector<CircleTrial> FitWithAll(const std::vector<const CircleRun*>& runs,
                                    const CauseOptions& options) {
  std::vector<CircleTrial> trials;
  FitTakenUp(runs, options, StatedSpike(options), trials);
  FitOwnForms(runs, options, trials);
  const std::array<double, 2> none{};
  for (const standards::SpikeForm& spike : SpikesLike(runs, options)) {
    FitSpikes(runs, options, spike, trials);
  }
  if (SpikesOf(MostLikely(trials).found) == none) return trials;
  FitTakenUp(runs, options, MostLikely(trials).form.spike, trials);
  FitOwnForms(runs, options, trials);
  return WithFormsOfTheirOwn(runs, options, trials);
}

}  // namespace

bool CircleCauses::TableHolds() const {
  constexpr double kNoNoise = 3.0;
  return beyond_noise < kNoNoise;
}

bool CircleCauses::IsCertain(const CauseEstimate& one) const {
  return one.seen && std::abs(one.value) > standards::kCoverage * one.u &&
         (TableHolds() || one.effect > kStandsOut * rms_after);
}

CircleCauses FitCircleCauses(const std::vector<const CircleRun*>& runs, CauseOptions options) {
  CheckCircles(runs);
  LimitOrders(runs, CausesOf(*runs.front(), options, {}).size(), options.smooth);
  const std::vector<CircleTrial> trials = FitWithAll(runs, options);
  const double rows = IndependentRows(runs, MostLikely(trials).found);
  const CircleTrial& likeliest = *std::ranges::max_element(
      trials, {}, [rows](const CircleTrial& trial) { return LogLikelihood(trial, rows); });
  CircleCauses best = likeliest.found;
  const double most = LogLikelihood(likeliest, rows);
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(std::ssize(best.causes));
  double sum = 0.0;
  for (const CircleTrial& trial : trials) {
    const double weight = std::exp(LogLikelihood(trial, rows) - most);
    mean += weight * ValuesOf(trial.found);
    sum += weight;
  }
  mean /= sum;
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(mean.size(), mean.size());
  for (const CircleTrial& trial : trials) {
    const Eigen::VectorXd off = ValuesOf(trial.found) - mean;
    const double weight = std::exp(LogLikelihood(trial, rows) - most) / sum;
    covariance += weight * (trial.found.covariance + off * off.transpose());
  }
  // The noise is known to so many degrees of freedom: 2 u is a U95 for all.
  const double t = standards::StudentWidening(best.freedom);
  covariance *= t * t;
  for (Eigen::Index i = 0; i < mean.size(); ++i) {
    CauseEstimate& one = best.causes[i];
    if (one.value != 0.0) one.effect *= std::abs(mean[i] / one.value);
    one.value = mean[i];
    one.u = std::sqrt(covariance(i, i));
  }
  best.covariance = std::move(covariance);
  return best;
}

}  // namespace abbe::fusion
