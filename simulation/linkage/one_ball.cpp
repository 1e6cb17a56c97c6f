#include "simulation/linkage/one_ball.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "failure/failure.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;

constexpr Index kCompared = 300;  // poses
constexpr double kBeyondNoise = 10.0;

bool AreAlike(const LinkageRun& one, Index i, const LinkageRun& other, Index j) {
  return (one.readings.angles.col(i) - other.readings.angles.col(j)).cwiseAbs().maxCoeff() <
         OneBall::kSameAngle;
}

// Poses of `one` and of `other` with the same angles.
std::vector<std::pair<Index, Index>> Matches(const LinkageRun& one, const LinkageRun& other) {
  std::vector<std::pair<Index, Index>> matches;
  for (Index j = 0; j < other.poses(); ++j) {
    for (Index i = 0; i < one.poses(); ++i) {
      if (!AreAlike(one, i, other, j)) continue;
      matches.emplace_back(i, j);
      break;
    }
  }
  return matches;
}

// By how much distances differ, usually; 0 where too few poses tell.
double DistancesDiffer(const LinkageRun& one, const LinkageRun& other) {
  const auto matches = Matches(one, other);
  std::vector<double> differences;
  for (std::size_t k = 1; k < matches.size(); ++k) {
    const auto [i, j] = matches[k - 1];
    const auto [next_i, next_j] = matches[k];
    if (AreAlike(one, i, one, next_i)) continue;  // it stood, or its angles are not filled in
    const double there = (one.reference.col(next_i) - one.reference.col(i)).norm();
    const double here = (other.reference.col(next_j) - other.reference.col(j)).norm();
    differences.push_back(std::abs(here - there));
  }
  if (std::ssize(differences) < OneBall::kFewest) return 0.0;
  const auto middle = differences.begin() + (differences.size() / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  return *middle;
}

}  // namespace

void OneBall::Add(const recording::Recording& recording, const LinkageRun& run) {
  const std::string ball = recording.HeaderText("mounting.ball").value_or("");
  const LinkageRun some = AtMost(run, kCompared);
  for (const auto& [other_ball, known] : known_) {
    if (!ball.empty() && !other_ball.empty() && ball != other_ball) {
      throw InputError(fmt::format("{}: header: mounting.ball is \"{}\", and \"{}\" in {}; {}",
                                   run.name, ball, other_ball, known.name, advice_));
    }
    if (known.mounting != run.mounting ||
        known.readings.angles.rows() != run.readings.angles.rows()) {
      continue;
    }
    const double noise = std::max(known.reference_sd.maxCoeff(), run.reference_sd.maxCoeff());
    const double differ = DistancesDiffer(known, some);
    if (differ < std::max(kApart, kBeyondNoise * noise)) continue;
    throw InputError(
        fmt::format("{}: at the angles of {} the ball is elsewhere, distances between poses differ "
                    "by {:.3g} mm: these are two balls; {}",
                    run.name, known.name, 1e3 * differ, advice_));
  }
  known_.push_back({ball, run});
}

}  // namespace abbe::simulation
