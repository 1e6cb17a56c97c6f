// A figure over time: its rate of change, and when it is expected to reach its limit.
//
//   const Trend trend = FollowFigure(points, instruments, {.limit = 5.0, .now = now});
//   if (trend.fit) fmt::print("{} +- {}\n", trend.fit->rate, trend.fit->U95_rate);
//
// Model: y_i = a + b (t_i - t_0) + e_i, var e_i = u_i^2 + s^2. u_i is what of the standard
// uncertainty of point i belongs to it alone: the part of an instrument that all points share
// shifts all of them and no rate, and is added to the level only. s is the excess scatter: what the
// points scatter beyond u_i. It solves sum (y_i - a - b (t_i - t_0))^2 / (u_i^2 + s^2) = n - 2, or
// is 0 where they scatter less. t_0 is the weighted mean instant. Points without a stated
// uncertainty take the median of the others; without any, the fit is ordinary least squares.
//
// A scatter that goes on from one campaign to the next (the room, the season) leaves fewer scatters
// than points: its part of the variances grows by (1 + r) / (1 - r), r its correlation from one to
// the next, corrected for the line by (n r + 3) / (n - 4), of 8 points and more.
//
// Coverage by Student's t with n - 2 degrees of freedom. The limit: where |a + b (t - t_0)| meets
// it, by Fieller's theorem; without a significant rate only the earliest instant is given.
//
// Shapes: one entry a point, in the order of the points given. Units: seconds since 1970, rates per
// second, values in that of the figure. Failure: none is thrown; `notes` say what is wrong with the
// points. Source: R. C. Paule and J. Mandel, J. Res. NBS 87 (1982) 377-385, for the excess; G.
// Knapp and J. Hartung, Stat. Med. 22 (2003) 2693-2710, for the coverage; E. C. Fieller, J. R.
// Stat. Soc. B 16 (1954) 175-185. Validity: a steady drift; a scatter whose memory is shorter than
// the campaigns together (a random walk still looks like a drift in one of four). Wear and
// collisions do not keep to a line; the excess scatter then grows.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "history/store.h"

namespace abbe::history {

struct TrendOptions {
  std::optional<double> limit{};
  double now = 0.0;  // points beyond it, and a day, are left out
};

struct TrendPoint {
  Point point;
  double u_own = 0.0;
  bool used = true;  // false: dated in the future
};

struct LimitReached {
  bool already = false;                    // the line is beyond the limit now
  std::optional<double> expected;          // where the line meets the limit
  std::optional<double> earliest, latest;  // of the 95 % interval; none: never within it
};

struct TrendFit {
  double at = 0.0, value = 0.0, U95_value = 0.0;  // t_0 and the level there
  double rate = 0.0, U95_rate = 0.0;
  double u_value = 0.0, u_rate = 0.0, u_common = 0.0;
  double excess = 0.0;    // s
  double memory = 0.0;    // correlation of the excess scatter from one campaign to the next
  double coverage = 0.0;  // of Student
  bool drifts = false;    // the rate is beyond its U95

  double At(double instant) const { return value + rate * (instant - at); }
  double U95At(double instant) const;
};

struct Trend {
  std::string object, quantity, conditions;
  std::vector<TrendPoint> points;
  std::optional<double> limit{};
  std::optional<TrendFit> fit;  // none: fewer than three instants
  std::optional<LimitReached> reached;
  std::vector<std::string> notes;

  // The campaign that was measured last, of those in the fit.
  const Point& Last() const;
  // Whether that is beyond the limit, not the line alone; false without a limit or a fit.
  bool MeasuredBeyond() const;
};

// `points` of one figure under one set of conditions; `instruments` by campaign.
Trend FollowFigure(const std::vector<Point>& points,
                   const std::map<long long, std::map<std::string, std::string>>& instruments,
                   const TrendOptions& options);

// Campaigns that were added after others but are dated before them, in words.
std::vector<std::string> OutOfOrder(const std::vector<CampaignHead>& campaigns);

}  // namespace abbe::history
