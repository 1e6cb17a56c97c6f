#include "standards/narrowest_annulus.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "failure/failure.h"

namespace abbe::standards {
namespace {

constexpr int kMaxRounds = 1000;
// Relative to the largest radius: how far a point may be outside the zone by rounding.
constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();

// Distance of the point from the shifted centre, to first order.
double Distance(const Annulus& zone, const AnnulusPoint& point) {
  return point.r - zone.x * point.u - zone.y * point.v;
}

bool Holds(const Annulus& zone, const std::vector<AnnulusPoint>& points, double tolerance) {
  return std::all_of(points.begin(), points.end(), [&](const AnnulusPoint& point) {
    const double distance = Distance(zone, point);
    return distance <= zone.outer + tolerance && distance >= zone.inner - tolerance;
  });
}

// The zone on whose borders the four points lie, the first `on_outer` of them on the outer one.
std::optional<Annulus> ZoneThrough(const std::array<AnnulusPoint, 4>& points, int on_outer) {
  Eigen::Matrix4d A;
  Eigen::Vector4d b;
  for (int i = 0; i < 4; ++i) {
    const AnnulusPoint& point = points[i];
    A.row(i) << point.u, point.v, (i < on_outer ? 1.0 : 0.0), (i < on_outer ? 0.0 : 1.0);
    b[i] = point.r;
  }
  const Eigen::FullPivLU<Eigen::Matrix4d> lu(A);
  if (!lu.isInvertible()) return std::nullopt;
  const Eigen::Vector4d solution = lu.solve(b);
  return Annulus{solution[0], solution[1], solution[2], solution[3]};
}

// Steps to the next choice of choice.size() of the numbers below n; false after the last.
bool NextChoice(std::vector<std::size_t>& choice, std::size_t n) {
  const std::size_t count = choice.size();
  for (std::size_t i = count; i-- > 0;) {
    if (choice[i] + (count - i) < n) {
      ++choice[i];
      for (std::size_t k = i + 1; k < count; ++k) choice[k] = choice[k - 1] + 1;
      return true;
    }
  }
  return false;
}

std::vector<std::size_t> FirstChoice(int count) {
  std::vector<std::size_t> choice(count);
  for (std::size_t i = 0; i < choice.size(); ++i) choice[i] = i;
  return choice;
}

// The narrowest zone of a few points: at a vertex of the feasible set four distances lie on the
// borders, one to three of them on the outer one.
Annulus SmallProgramme(const std::vector<AnnulusPoint>& points, double tolerance) {
  Annulus best{0, 0, std::numeric_limits<double>::infinity(), 0};
  for (int on_outer = 1; on_outer <= 3; ++on_outer) {
    std::vector<std::size_t> outer = FirstChoice(on_outer);
    do {
      std::vector<std::size_t> inner = FirstChoice(4 - on_outer);
      do {
        std::array<AnnulusPoint, 4> chosen{};
        std::size_t next = 0;
        for (const std::size_t i : outer) chosen[next++] = points[i];
        for (const std::size_t i : inner) chosen[next++] = points[i];
        const auto zone = ZoneThrough(chosen, on_outer);
        if (zone && zone->Width() < best.Width() && Holds(*zone, points, tolerance)) best = *zone;
      } while (NextChoice(inner, points.size()));
    } while (NextChoice(outer, points.size()));
  }
  return best;
}

// Four points in directions as far apart as the points allow.
std::vector<AnnulusPoint> Spread(std::span<const AnnulusPoint> points) {
  std::vector<AnnulusPoint> spread{points.front()};
  const auto apart = [&spread](const AnnulusPoint& point) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const AnnulusPoint& one : spread) {
      nearest = std::min(nearest, std::hypot(point.u - one.u, point.v - one.v));
    }
    return nearest;
  };
  while (spread.size() < 4) {
    spread.push_back(*std::max_element(
        points.begin(), points.end(),
        [&](const AnnulusPoint& a, const AnnulusPoint& b) { return apart(a) < apart(b); }));
  }
  return spread;
}

}  // namespace

Annulus NarrowestAnnulus(std::span<const AnnulusPoint> points) {
  double largest = 0.0;
  for (const AnnulusPoint& point : points) largest = std::max(largest, point.r);
  const double tolerance = kRounding * largest;
  std::vector<AnnulusPoint> active = Spread(points);
  double width = -1.0;
  for (int round = 0; round < kMaxRounds; ++round) {
    const Annulus zone = SmallProgramme(active, tolerance);
    if (!std::isfinite(zone.Width())) break;
    const auto nearer = [&zone](const AnnulusPoint& a, const AnnulusPoint& b) {
      return Distance(zone, a) < Distance(zone, b);
    };
    const auto [inmost, outmost] = std::minmax_element(points.begin(), points.end(), nearer);
    const bool beyond = Distance(zone, *outmost) > zone.outer + tolerance;
    const bool within = Distance(zone, *inmost) < zone.inner - tolerance;
    if (!beyond && !within) return zone;
    if (zone.Width() > width + tolerance) {
      std::erase_if(active, [&](const AnnulusPoint& point) {
        const double distance = Distance(zone, point);
        return distance < zone.outer - tolerance && distance > zone.inner + tolerance;
      });
      width = zone.Width();
    }
    if (beyond) active.push_back(*outmost);
    if (within) active.push_back(*inmost);
  }
  throw NumericalError(fmt::format(
      "minimum zone of {} points: not found in {} rounds; do the points surround the centre?",
      points.size(), kMaxRounds));
}

}  // namespace abbe::standards
