#include "history/trend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "history/shared_uncertainty.h"
#include "recording/instant.h"
#include "standards/student_coverage.h"

namespace abbe::history {
namespace {

using InstrumentsByCampaign = std::map<long long, Instruments>;

constexpr double kDay = 86400.0;
constexpr std::size_t kFewest = 3;  // points of a fit

// The instruments whose part all points have in common.
std::set<std::string> CommonRoles(const std::vector<TrendPoint>& points,
                                  const InstrumentsByCampaign& instruments) {
  static const Instruments none;
  const auto of = [&](const TrendPoint& point) -> const Instruments& {
    const auto at = instruments.find(point.point.campaign);
    return at == instruments.end() ? none : at->second;
  };
  std::set<std::string> roles;
  for (const auto& share : points.front().point.figure.shares) {
    const std::string& role = share.first;
    const bool common = std::ranges::all_of(points, [&](const TrendPoint& each) {
      return each.point.figure.shares.contains(role) &&
             IsShared(role, of(points.front()), of(each));
    });
    if (common) roles.insert(role);
  }
  return roles;
}

// Splits the uncertainty of each point; returns the mean common part.
double SplitUncertainty(std::vector<TrendPoint>& points, const InstrumentsByCampaign& instruments) {
  const std::set<std::string> common = CommonRoles(points, instruments);
  double sum = 0.0;
  std::vector<double> stated;
  for (TrendPoint& each : points) {
    const Figure& figure = each.point.figure;
    if (!figure.u) continue;
    double shared = 0.0;
    for (const auto& [role, share] : figure.shares) shared += common.contains(role) ? share : 0.0;
    each.u_own = *figure.u * std::sqrt(std::max(0.0, 1.0 - shared));
    sum += *figure.u * std::sqrt(std::min(1.0, shared));
    stated.push_back(each.u_own);
  }
  if (stated.empty()) return 0.0;
  std::ranges::nth_element(stated, stated.begin() + static_cast<std::ptrdiff_t>(stated.size() / 2));
  for (TrendPoint& each : points) {
    if (!each.point.figure.u) each.u_own = stated[stated.size() / 2];
  }
  return sum / static_cast<double>(stated.size());
}

struct Line {
  double at = 0.0, value = 0.0, rate = 0.0;
  double variance_value = 0.0, variance_rate = 0.0;
  double chi_square = 0.0;
};

// Least squares with the weights 1 / (u_own^2 + excess), in days from the first point.
Line FitLine(const std::vector<TrendPoint>& points, double excess) {
  Line line;
  double weights = 0.0, values = 0.0, squares = 0.0, products = 0.0;
  const auto weight = [&](const TrendPoint& each) {
    return 1.0 / (each.u_own * each.u_own + excess);
  };
  const double first = points.front().point.measured;
  for (const TrendPoint& each : points) {
    weights += weight(each);
    line.at += weight(each) * (each.point.measured - first);
    values += weight(each) * each.point.figure.value;
  }
  line.at = first + line.at / weights;
  line.value = values / weights;
  for (const TrendPoint& each : points) {
    const double t = each.point.measured - line.at;
    squares += weight(each) * t * t;
    products += weight(each) * t * (each.point.figure.value - line.value);
  }
  line.rate = products / squares;
  line.variance_value = 1.0 / weights;
  line.variance_rate = 1.0 / squares;
  for (const TrendPoint& each : points) {
    const double left =
        each.point.figure.value - line.value - line.rate * (each.point.measured - line.at);
    line.chi_square += weight(each) * left * left;
  }
  return line;
}

bool StatesNone(const std::vector<TrendPoint>& points) {
  return std::ranges::all_of(points, [](const TrendPoint& each) { return each.u_own == 0.0; });
}

// The excess variance by Paule and Mandel: chi-square falls as it grows.
double ExcessOf(const std::vector<TrendPoint>& points) {
  const double wanted = static_cast<double>(points.size()) - 2.0;
  if (StatesNone(points)) return FitLine(points, 1.0).chi_square / wanted;
  if (FitLine(points, 0.0).chi_square <= wanted) return 0.0;
  double low = 0.0, high = FitLine(points, 1.0).chi_square;
  while (FitLine(points, high).chi_square > wanted) high *= 2.0;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (FitLine(points, middle).chi_square > wanted ? low : high) = middle;
  }
  return high;
}

// Correlation of the scatter from one campaign to the next, in the order of time, corrected for the
// line that was taken out; 0 for too few campaigns to estimate it.
double MemoryOf(std::vector<TrendPoint> points, const Line& line, double excess) {
  constexpr std::size_t kFewestForMemory = 8;
  constexpr double kMostMemory = 0.95;
  if (points.size() < kFewestForMemory) return 0.0;
  std::ranges::sort(points, {}, [](const TrendPoint& each) { return each.point.measured; });
  double products = 0.0, squares = 0.0, before = 0.0;
  for (const TrendPoint& each : points) {
    const double left =
        (each.point.figure.value - line.value - line.rate * (each.point.measured - line.at)) /
        std::sqrt(each.u_own * each.u_own + excess);
    products += left * before;
    squares += left * left;
    before = left;
  }
  if (squares == 0.0) return 0.0;
  const auto n = static_cast<double>(points.size());
  return std::clamp((n * products / squares + 3.0) / (n - 4.0), 0.0, kMostMemory);
}

// By how much the variances of level and rate are larger than of as many scatters apart.
double InflationOf(const std::vector<TrendPoint>& points, double excess, double memory) {
  double share = 0.0;  // of the excess in the variance of the points
  for (const TrendPoint& each : points) share += excess / (each.u_own * each.u_own + excess);
  share /= static_cast<double>(points.size());
  return 1.0 + share * ((1.0 + memory) / (1.0 - memory) - 1.0);
}

TrendFit Fit(const std::vector<TrendPoint>& points, double u_common) {
  const double excess = ExcessOf(points);
  // Without any uncertainty a perfect line leaves no scatter, and no weights.
  const bool exact = StatesNone(points) && excess == 0.0;
  Line line = FitLine(points, exact ? 1.0 : excess);
  TrendFit fit;
  if (excess > 0.0) {
    fit.memory = MemoryOf(points, line, excess);
    const double inflation = InflationOf(points, excess, fit.memory);
    line.variance_value *= inflation;
    line.variance_rate *= inflation;
  }
  fit.at = line.at;
  fit.value = line.value;
  fit.rate = line.rate;
  fit.excess = std::sqrt(excess);
  fit.u_value = exact ? 0.0 : std::sqrt(line.variance_value);
  fit.u_rate = exact ? 0.0 : std::sqrt(line.variance_rate);
  fit.u_common = u_common;
  fit.coverage = standards::StudentCoverage(static_cast<double>(points.size()) - 2.0);
  fit.U95_value = fit.coverage * std::hypot(fit.u_value, u_common);
  fit.U95_rate = fit.coverage * fit.u_rate;
  fit.drifts = std::abs(fit.rate) > fit.U95_rate;
  return fit;
}

// Where a + b x, x = t - t_0, meets the bound, and the x that it may do so at by Fieller's theorem:
// (a - bound + b x)^2 <= k^2 (u_a^2 + u_b^2 x^2).
LimitReached Reach(const TrendFit& fit, double bound, double now) {
  LimitReached reached;
  const double gap = fit.value - bound;
  const double k2 = fit.coverage * fit.coverage;
  const double u2 = fit.u_value * fit.u_value + fit.u_common * fit.u_common;
  const double square = fit.rate * fit.rate - k2 * fit.u_rate * fit.u_rate;
  const double half = fit.rate * gap, constant = gap * gap - k2 * u2;
  const double root = half * half - square * constant;
  if (fit.drifts) {
    const double crossing = fit.at - gap / fit.rate;
    reached.expected = crossing;
    reached.already = crossing <= now;
    const double spread = std::sqrt(std::max(root, 0.0));
    const double one = fit.at + (-half - spread) / square;
    const double other = fit.at + (-half + spread) / square;
    reached.earliest = std::min(one, other);
    reached.latest = std::max(one, other);
  } else if (constant > 0.0 && root > 0.0 && square != 0.0) {
    // Below the bound at t_0: the band meets it on both sides, the later one lies ahead.
    const double spread = std::sqrt(root);
    reached.earliest = fit.at + std::max((-half - spread) / square, (-half + spread) / square);
  } else if (constant <= 0.0) {
    reached.earliest = now;
  }
  return reached;
}

void AddLimit(const TrendOptions& options, Trend& trend) {
  if (!options.limit || !trend.fit) return;
  const TrendFit& fit = *trend.fit;
  const double limit = *options.limit;
  const double here = fit.At(options.now);
  if (std::abs(here) > limit) {
    trend.reached = Reach(fit, here > 0.0 ? limit : -limit, options.now);
    trend.reached->already = true;
    return;
  }
  // A range cannot fall below zero, so a falling one never meets its limit.
  if (fit.rate < 0.0 && !IsSigned(trend.quantity)) {
    if (!fit.drifts) trend.reached = Reach(fit, limit, options.now);
    return;
  }
  trend.reached = Reach(fit, fit.rate < 0.0 ? -limit : limit, options.now);
}

}  // namespace

double TrendFit::U95At(double instant) const {
  const double t = instant - at;
  return coverage * std::sqrt(u_value * u_value + u_common * u_common + u_rate * u_rate * t * t);
}

const Point& Trend::Last() const {
  const TrendPoint* last = nullptr;
  for (const TrendPoint& each : points) {
    if (each.used && (last == nullptr || each.point.measured >= last->point.measured)) last = &each;
  }
  return last->point;
}

bool Trend::MeasuredBeyond() const {
  return fit && limit && std::abs(Last().figure.value) > *limit;
}

Trend FollowFigure(const std::vector<Point>& points,
                   const std::map<long long, std::map<std::string, std::string>>& instruments,
                   const TrendOptions& options) {
  Trend trend;
  trend.limit = options.limit;
  std::vector<TrendPoint> used;
  for (const Point& each : points) {
    TrendPoint point{each, each.figure.u.value_or(0.0), each.measured <= options.now + kDay};
    trend.points.push_back(point);
    if (point.used) used.push_back(point);
  }
  if (points.empty()) return trend;
  trend.object = points.front().figure.object;
  trend.quantity = points.front().figure.quantity;
  trend.conditions = points.front().figure.conditions;
  if (const auto future = trend.points.size() - used.size(); future > 0) {
    const auto first = std::ranges::find(trend.points, false, &TrendPoint::used);
    trend.notes.push_back(fmt::format(
        "{} of its campaigns {} dated in the future (campaign {}, {}) and left out of the fit: "
        "check the clock of the computer that measured",
        future, future == 1 ? "is" : "are", first->point.campaign,
        recording::InstantText(first->point.measured)));
  }
  std::set<double> instants;
  for (const TrendPoint& each : used) instants.insert(each.point.measured);
  if (instants.size() < kFewest) {
    trend.notes.push_back(fmt::format("{} instant{}: a rate takes at least {}", instants.size(),
                                      instants.size() == 1 ? "" : "s", kFewest));
    return trend;
  }
  const double u_common = SplitUncertainty(used, instruments);
  std::size_t next = 0;
  for (TrendPoint& each : trend.points) {
    if (each.used) each.u_own = used[next++].u_own;
  }
  trend.fit = Fit(used, u_common);
  AddLimit(options, trend);
  return trend;
}

std::vector<std::string> OutOfOrder(const std::vector<CampaignHead>& campaigns) {
  std::vector<CampaignHead> added = campaigns;
  std::ranges::sort(added, {}, &CampaignHead::id);
  std::vector<std::string> notes;
  const CampaignHead* latest = nullptr;
  for (const CampaignHead& each : added) {
    if (latest != nullptr && each.measured < latest->measured) {
      notes.push_back(fmt::format(
          "campaign {} was added after campaign {} but is dated before it ({}, {}): if it was "
          "measured later, a clock jumped",
          each.id, latest->id, recording::InstantText(each.measured),
          recording::InstantText(latest->measured)));
    } else {
      latest = &each;
    }
  }
  return notes;
}

}  // namespace abbe::history
