#include "fusion/circle_causes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "failure/failure.h"
#include "fusion/circle_trial.h"
#include "standards/circle_signatures.h"
#include "standards/coverage.h"
#include "standards/student_coverage.h"

namespace abbe::fusion {
namespace {

using paths::CircleRun;

constexpr double kSameRadius = 0.01;      // of the radius: lag makes a fast circle smaller
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

// What a cause is found to be on each axis; 0 where that is no more than `least` times its u.
std::array<double, 2> OfBothAxes(const std::string& cause, const CircleCauses& found,
                                 double least = 0.0) {
  std::array<double, 2> values{};
  std::size_t axis = 0;
  for (const CauseEstimate& one : found.causes) {
    if (one.cause != cause) continue;
    if (std::abs(one.value) > least * one.u) values[axis] = one.value;
    ++axis;
  }
  return values;
}

const CircleTrial& MostLikely(const std::vector<CircleTrial>& trials) {
  return *std::ranges::min_element(trials, {}, [](const CircleTrial& one) { return one.white; });
}

// The spikes that are far beyond chance: of smaller ones the form does not matter.
std::array<double, 2> SpikesOf(const CircleCauses& found) {
  return OfBothAxes("reversal_spike", found, 5.0);
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
      form.wound_up = OfBothAxes("backlash", trial.found, standards::kCoverage);
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

standards::SpikeForm StatedSpike(const CauseOptions& options) {
  return {.width = {options.spike_width, options.spike_width}};
}

// The fits with all ways in which backlash may be taken up, beside spikes as they are stated.
std::vector<CircleTrial> FitTakenUp(const std::vector<const CircleRun*>& runs,
                                    const CauseOptions& options) {
  constexpr int kRounds = 4;  // each brings the way closer to the play by a factor of five
  constexpr std::array kWays{0.5e-6, 1e-6,   2e-6, 5e-6, 10e-6, 20e-6, 50e-6, 100e-6,
                             200e-6, 500e-6, 1e-3, 2e-3, 3e-3,  5e-3,  8e-3};  // m
  const auto fitted = [&](const ReversalForm& form) { return FitWith(runs, options, form); };
  ReversalForm form{.spike = StatedSpike(options)};
  std::vector<CircleTrial> trials{fitted(form)};
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
  if (const CircleTrial& best = MostLikely(trials);
      best.form.how == standards::TakenUp::kByWindUp) {
    trials.push_back(WithOwnForm(runs, options, best));
  }
  return trials;
}

// The logarithm of the marginal likelihood of a fit, up to what is the same for all. `rows`:
// independent ones.
double LogLikelihood(const CircleTrial& trial, double rows) {
  return -rows * std::log(std::max(trial.white, kLeastRadialNoise)) - trial.improbable;
}

double IndependentRows(const std::vector<const CircleRun*>& runs, const CircleCauses& fit) {
  return static_cast<double>(Rows(runs)) / (fit.correlated * fit.correlated);
}

Eigen::VectorXd ValuesOf(const CircleCauses& fit) {
  Eigen::VectorXd values(fit.causes.size());
  for (Eigen::Index i = 0; i < values.size(); ++i) values[i] = fit.causes[i].value;
  return values;
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

// Fits in `form` with widths of spikes of so many times its own.
std::vector<CircleTrial> WithWidths(const std::vector<const CircleRun*>& runs,
                                    const CauseOptions& options, const ReversalForm& form,
                                    std::span<const double> widths) {
  std::vector<CircleTrial> trials;
  for (const double times : widths) {
    ReversalForm changed = form;
    for (double& width : changed.spike.width) width *= times;
    trials.push_back(FitWith(runs, options, changed));
  }
  return trials;
}

// The form of backlash of a trial beside spikes of this form.
ReversalForm Beside(const standards::SpikeForm& spike, const CircleTrial& trial) {
  return {.how = trial.form.how, .way = trial.form.way, .spike = spike};
}

// Whether spikes of some form suit the runs better than any of `trials`, or these have some.
bool HasSpikes(const std::vector<const CircleRun*>& runs, const CauseOptions& options,
               const std::vector<standards::SpikeForm>& spikes,
               const std::vector<CircleTrial>& trials) {
  constexpr std::array kWidths{0.3, 1.0, 3.0};  // of that stated
  std::vector<CircleTrial> best{MostLikely(trials)};
  for (const standards::SpikeForm& spike : spikes) {
    std::ranges::move(WithWidths(runs, options, Beside(spike, MostLikely(trials)), kWidths),
                      std::back_inserter(best));
  }
  return SpikesOf(MostLikely(best).found) != std::array<double, 2>{};
}

// For each way in which backlash may be taken up the best of `trials`.
std::vector<CircleTrial> BestOfEachWay(const std::vector<CircleTrial>& trials) {
  std::map<standards::TakenUp, std::vector<CircleTrial>> of_way;
  for (const CircleTrial& trial : trials) of_way[trial.form.how].push_back(trial);
  std::vector<CircleTrial> best;
  best.reserve(of_way.size());
  for (const auto& [how, all] : of_way) best.push_back(MostLikely(all));
  return best;
}

// In `form`, with the width of spikes that suits each axis best, and spikes not quite of that form.
// Without that the forms are not to be compared: one would take the part of another's.
CircleTrial WithSpikes(const std::vector<const CircleRun*>& runs, const CauseOptions& options,
                       const ReversalForm& form) {
  constexpr std::array kWidths{0.2, 0.3, 0.45, 0.67, 1.0, 1.5, 2.2, 3.3, 5.0};  // of that stated
  const CircleTrial own =
      WithOwnForm(runs, options, MostLikely(WithWidths(runs, options, form, kWidths)));
  ReversalForm formed = own.form;
  formed.spike_size = SpikesOf(own.found);
  return FitWith(runs, options, formed);
}

// Fits with all forms that a reversal may have: backlash taken up in every way and spikes of every
// form and width; where there are spikes, these not quite of the form of the table.
std::vector<CircleTrial> FitWithAll(const std::vector<const CircleRun*>& runs,
                                    const CauseOptions& options) {
  std::vector<CircleTrial> trials = FitTakenUp(runs, options);
  const std::vector<standards::SpikeForm> spikes = SpikesLike(runs, options);
  if (!HasSpikes(runs, options, spikes, trials)) return trials;
  const std::vector<CircleTrial> ways = BestOfEachWay(trials);
  std::vector<CircleTrial> formed;
  for (const standards::SpikeForm& spike : spikes) {
    for (const CircleTrial& way : ways) {
      formed.push_back(WithSpikes(runs, options, Beside(spike, way)));
    }
  }
  return formed;
}

// The same forms beside noise that remembers, where the fit of the likeliest tells that it does.
std::vector<CircleTrial> Remembering(const std::vector<const CircleRun*>& runs,
                                     const CauseOptions& options, std::vector<CircleTrial> trials) {
  const CircleMemory memory = MemoryBeside(runs, options, MostLikely(trials));
  if (memory.empty()) return trials;
  for (CircleTrial& trial : trials) trial = FitWith(runs, options, trial.form, memory);
  return trials;
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
  const std::vector<CircleTrial> trials = Remembering(runs, options, FitWithAll(runs, options));
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
