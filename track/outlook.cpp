#include "track/outlook.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "history/conformity.h"
#include "settings/unit.h"
#include "standards/coverage.h"

namespace abbe::track {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kDay = 86400.0, kLongest = 3652.0 * kDay;
constexpr int kStations = 25;     // over a travel
constexpr int kGrid = 4;          // points along an axis of the volume
constexpr std::size_t kMost = 3;  // tests of a choice
constexpr std::array kOfErrors{"straightness_um", "straightness_ls_um", "straightness_ends_um",
                               "range_um",        "range_urad",         "urad"};

// A limit of what a map states: variances now and after a day, of each place.
struct Quantity {
  std::string name;
  double limit;  // um or urad
  VectorXd now, later;
};

VectorXd StationsOf(const map::ErrorMap& map, int error) {
  if (error >= map::kErrors - 3) return VectorXd::Zero(1);
  const machine::Travel& travel = map.model().travels()[error / machine::kMotions];
  return VectorXd::LinSpaced(kStations, travel.first, travel.last);
}

// The largest eigenvalues of the covariances over the volume.
VectorXd VolumeVariances(const map::ErrorMap& map) {
  const auto& travels = map.model().travels();
  VectorXd variances(kGrid * kGrid * kGrid);
  Index at = 0;
  for (int i = 0; i < kGrid; ++i) {
    for (int j = 0; j < kGrid; ++j) {
      for (int k = 0; k < kGrid; ++k) {
        const std::array index{i, j, k};
        Eigen::Vector3d place;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const double share = static_cast<double>(index[axis]) / (kGrid - 1);
          place[axis] = travels[axis].first + share * (travels[axis].last - travels[axis].first);
        }
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(
            map.Covariance(place, map.origin().tool), Eigen::EigenvaluesOnly);
        variances[at++] = eigen.eigenvalues().maxCoeff();
      }
    }
  }
  return variances;
}

std::vector<Quantity> QuantitiesOf(const TrackedMap& tracked, const history::Limits& limits) {
  const map::ErrorMap now = tracked.Map();
  TrackedMap tomorrow = tracked;
  tomorrow.Follow({.time = tracked.time() + kDay});
  const map::ErrorMap later = tomorrow.Map();
  std::vector<Quantity> quantities;
  for (int error = 0; error < map::kErrors; ++error) {
    const std::string name = map::ErrorName(error);
    const VectorXd stations = StationsOf(now, error);
    if (error < map::kErrors - 3 &&
        now.model().Function(error / machine::kMotions, error % machine::kMotions).size() == 0) {
      continue;
    }
    for (const char* const quantity : kOfErrors) {
      const history::Limit* const limit = history::LimitOf(name, quantity, limits);
      if (limit == nullptr) continue;
      // A limit of all objects holds for those that have the quantity.
      const bool angle = error < map::kErrors - 3 && error % machine::kMotions >= 3;
      const bool of_angle = std::string(quantity) == "range_urad";
      if (limit->object.empty() && angle != of_angle) continue;
      if (limit->object.empty() && !angle && error >= map::kErrors - 3) continue;
      if (limit->object.empty() && !angle &&
          error / machine::kMotions == error % machine::kMotions) {
        continue;  // positioning is no straightness
      }
      quantities.push_back({name + "." + quantity, limit->size,
                            now.CurveOf(error, stations).u.array().square(),
                            later.CurveOf(error, stations).u.array().square()});
    }
  }
  const history::Limit* const volume = history::LimitOf("", "volumetric_um", limits);
  if (volume != nullptr) {
    quantities.push_back(
        {"volumetric_um", volume->size, VolumeVariances(now), VolumeVariances(later)});
  }
  return quantities;
}

double U95At(const Quantity& quantity, double days) {
  const VectorXd variances = quantity.now + days * (quantity.later - quantity.now);
  return standards::kCoverage * std::sqrt(std::max(variances.maxCoeff(), 0.0)) / settings::kMicro;
}

std::vector<Watched> WatchAt(const TrackedMap& tracked, const history::Limits& limits,
                             double days) {
  std::vector<Watched> watched;
  for (const Quantity& each : QuantitiesOf(tracked, limits)) {
    Watched one{each.name, each.limit, U95At(each, days), {}};
    const double most = std::pow(each.limit * settings::kMicro / standards::kCoverage, 2);
    double first = std::numeric_limits<double>::infinity();
    for (Index i = 0; i < each.now.size(); ++i) {
      const double rate = each.later[i] - each.now[i];
      if (each.now[i] >= most) first = 0.0;
      if (rate > 0.0) first = std::min(first, std::max(0.0, (most - each.now[i]) / rate));
    }
    if (first * kDay < kLongest) one.exceeded = tracked.time() + first * kDay;
    watched.push_back(std::move(one));
  }
  return watched;
}

bool AllKept(const std::vector<Watched>& watched) {
  return std::all_of(watched.begin(), watched.end(),
                     [](const Watched& each) { return each.U95 <= each.limit; });
}

// The largest U95 over its limit.
double Worst(const std::vector<Watched>& watched) {
  double worst = 0.0;
  for (const Watched& each : watched) worst = std::max(worst, each.U95 / each.limit);
  return worst;
}

}  // namespace

std::vector<Watched> Watch(const TrackedMap& tracked, const history::Limits& limits) {
  return WatchAt(tracked, limits, 0.0);
}

Choice NextTest(const TrackedMap& tracked, std::vector<Candidate> candidates,
                const history::Limits& limits, double horizon) {
  // Choices of few tests, as lists of candidates, the shortest first.
  std::vector<std::vector<std::size_t>> choices{{}};
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const std::size_t before = choices.size();
    for (std::size_t c = 0; c < before; ++c) {
      if (choices[c].size() == kMost) continue;
      choices.push_back(choices[c]);
      choices.back().push_back(i);
    }
  }
  const auto minutes = [&](const std::vector<std::size_t>& choice) {
    double sum = 0.0;
    for (const std::size_t i : choice) sum += candidates[i].minutes;
    return sum;
  };
  std::stable_sort(choices.begin(), choices.end(), [&](const auto& one, const auto& other) {
    return minutes(one) < minutes(other);
  });
  Choice best;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& choice : choices) {
    TrackedMap with = tracked;
    for (const std::size_t i : choice) with.Take(candidates[i].test);
    const std::vector<Watched> after = WatchAt(with, limits, horizon / kDay);
    const double worst = Worst(after);
    if (worst >= least) continue;
    least = worst;
    best = {AllKept(after), {}, minutes(choice), after};
    for (const std::size_t i : choice) best.tests.push_back(candidates[i].name);
    if (best.enough) break;
  }
  return best;
}

}  // namespace abbe::track
