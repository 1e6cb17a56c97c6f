#include "track/learn.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "failure/failure.h"
#include "track/maximum.h"

namespace abbe::track {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr std::size_t kFewest = 4;
constexpr double kLeastFactor = 1e-3, kLargestFactor = 100.0;
constexpr double kShortestLag = 30.0, kLongestLag = 2e5;  // s
constexpr double kFirstLag = 1800.0;                      // s
constexpr int kRounds = 2;

machine::Population Times(machine::Population walk, double factor) {
  for (double* size : {&walk.positioning, &walk.straightness, &walk.roll, &walk.pitch, &walk.yaw,
                       &walk.squareness, &walk.scale}) {
    *size *= factor;
  }
  return walk;
}

// theta: logarithm of the factor, then of the lags that are learned.
class Learning {
 public:
  Learning(const TrackedMap& start, const std::vector<HistoryStep>& history,
           const std::vector<bool>& lags)
      : start_(start), history_(history), learned_(lags) {
    for (const HistoryStep& step : history) start_.Know(step.runs);
    // Linearised once.
    TrackedMap now = start_;
    for (const HistoryStep& step : history) {
      for (const Conditions& each : step.followed) now.Follow(each);
      LinearRun run = now.Test(step.runs);
      now.Take(run.test);
      tests_.push_back(std::move(run.test));
    }
  }

  TrackedMap At(const VectorXd& theta) const {
    TrackedMap map = start_;
    map.SetWalk(Times(start_.walk(), std::exp(theta[0])));
    Index next = 1;
    for (std::size_t s = 0; s < learned_.size(); ++s) {
      if (learned_[s]) map.SetLag(s, std::exp(theta[next++]));
    }
    return map;
  }

  double LogLikelihood(const VectorXd& theta) const {
    TrackedMap map = At(theta);
    double log = 0.0;
    for (std::size_t t = 0; t < history_.size(); ++t) {
      for (const Conditions& each : history_[t].followed) map.Follow(each);
      log += map.Take(tests_[t]);
    }
    return log;
  }

 private:
  TrackedMap start_;
  const std::vector<HistoryStep>& history_;
  std::vector<bool> learned_;
  std::vector<LinearTest> tests_;
};

}  // namespace

Learned Learn(const TrackedMap& start, const std::vector<HistoryStep>& history,
              const std::vector<bool>& lags) {
  if (history.size() < kFewest) {
    throw InputError(
        fmt::format("{} short tests tell no walk: --learn takes at least {}, on different days",
                    history.size(), kFewest));
  }
  const Learning learning(start, history, lags);
  const auto count = 1 + std::count(lags.begin(), lags.end(), true);
  VectorXd first(count), low(count), high(count);
  first.setConstant(std::log(kFirstLag));
  low.setConstant(std::log(kShortestLag));
  high.setConstant(std::log(kLongestLag));
  first[0] = 0.0;
  low[0] = std::log(kLeastFactor);
  high[0] = std::log(kLargestFactor);
  const VectorXd theta = Maximum([&](const VectorXd& at) { return learning.LogLikelihood(at); },
                                 first, low, high, count > 1 ? kRounds : 1);
  Learned learned{.factor = std::exp(theta[0]),
                  .lags = {},
                  .gain = learning.LogLikelihood(theta) - learning.LogLikelihood(first),
                  .map = learning.At(theta)};
  for (const map::Warmth& each : learned.map.sensors()) learned.lags.push_back(each.lag);
  return learned;
}

}  // namespace abbe::track
