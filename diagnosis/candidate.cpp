#include "diagnosis/candidate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "diagnosis/standing_pairs.h"
#include "simulation/causes/registry.h"

namespace abbe::diagnosis {

namespace {

// A length in the motion of an axis.
bool ScalesWith(const simulation::Cause& cause, const simulation::Object& object) {
  return cause.CorrectedAt(object) != simulation::CorrectedBy::kInstrument &&
         std::any_of(cause.keys.begin(), cause.keys.end(),
                     [](const auto& key) { return key.name.ends_with("_um"); });
}

// 0, 1, 2, of an object of axes; empty for any other.
std::vector<int> AxesOfObject(const simulation::Object& object) {
  if (!object.IsOfAxes()) return {};
  if (object.kind() == simulation::Object::Kind::kAxis) return {object.first()};
  return {object.first(), object.second()};
}

// An object with axes has only such as the machine has.
bool IsOnMachine(const simulation::Scene& scene, const simulation::Object& object) {
  return std::ranges::all_of(AxesOfObject(object),
                             [&](int axis) { return scene.travel[axis] > 0.0; });
}

// Between all rows of all runs. Beyond the jitter of a drive that stands.
bool Moves(const simulation::Scene& scene, int axis) {
  constexpr double kJitter = 1e-3;  // of the travel
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const simulation::Trace* trace : scene.traces) {
    if (trace->axes.cols() == 0) continue;
    least = std::min(least, trace->axes.row(axis).minCoeff());
    most = std::max(most, trace->axes.row(axis).maxCoeff());
  }
  return most - least > kJitter * scene.travel[axis];
}

}  // namespace

bool IsStandingPair(const simulation::Scene& scene, const simulation::Object& object) {
  const std::vector<int> axes = AxesOfObject(object);
  return axes.size() > 1 &&
         !std::ranges::all_of(axes, [&](int axis) { return Moves(scene, axis); });
}

bool IsAmong(const std::vector<Candidate>& candidates, const Candidate& candidate) {
  return std::ranges::any_of(
      candidates, [&](const Candidate& other) { return other.Name() == candidate.Name(); });
}

double CoarsenessOf(const machine::Population& population) {
  constexpr double kFine = 2e-6;  // m
  return std::max(1.0, population.positioning / kFine);
}

std::vector<Candidate> AllCandidates(const simulation::Scene& scene, double coarseness) {
  std::vector<Candidate> candidates;
  for (const simulation::Cause& cause : simulation::Causes()) {
    for (const simulation::Object& object : cause.objects(scene)) {
      if (!IsOnMachine(scene, object) || IsStandingPair(scene, object)) continue;
      const double own = ScalesWith(cause, object) ? coarseness : 1.0;
      for (const Eigen::VectorXd& shape : cause.ShapesFor(scene, object)) {
        candidates.push_back({&cause, object, shape, {}, own});
      }
    }
  }
  return candidates;
}

std::vector<Candidate> CandidatesOf(const Campaign& campaign) {
  const simulation::Scene scene = campaign.scene();
  std::vector<Candidate> candidates =
      AllCandidates(scene, CoarsenessOf(campaign.instruments().machine.population));
  for (const auto& carried : campaign.carried()) {
    for (const simulation::Object& object : carried->cause().objects(scene)) {
      candidates.push_back({&carried->cause(), object, {}});
    }
  }
  return candidates;
}

std::vector<std::string> StandingPairs(const simulation::Scene& scene) {
  std::vector<std::string> names;
  for (const simulation::Cause& cause : simulation::Causes()) {
    for (const simulation::Object& object : cause.objects(scene)) {
      if (!IsOnMachine(scene, object) || !IsStandingPair(scene, object)) continue;
      names.push_back(Candidate{&cause, object, {}}.Name());
    }
  }
  return names;
}

Keys KeysOf(const Score& score) {
  constexpr double kStep = 1e-3;  // standard uncertainties
  // The first number of the shape of a random field is its size.
  const Eigen::Index sized =
      score.candidate.cause->IsRandomField() ? 1 : score.candidate.shape.size();
  const auto values_at = [&](const Eigen::VectorXd& off) -> Eigen::VectorXd {
    const Eigen::Index count = score.coefficients.size();
    Eigen::VectorXd shape = score.candidate.shape;
    if (off.size() > count) shape.head(sized) *= std::exp(off[count]);
    return score.candidate.cause->ValuesOf(score.coefficients + off.head(count), shape);
  };
  const Eigen::Index count = score.covariance.rows();
  Keys keys{values_at(Eigen::VectorXd::Zero(count)), {}};
  Eigen::MatrixXd J(keys.values.size(), count);
  for (Eigen::Index c = 0; c < count; ++c) {
    const double step = std::max(kStep * std::sqrt(score.covariance(c, c)), 1e-300);
    J.col(c) = (values_at(step * Eigen::VectorXd::Unit(count, c)) - keys.values) / step;
  }
  keys.u = (J * score.covariance * J.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt();
  return keys;
}

const simulation::CauseKey* BeyondBounds(const Score& score) {
  const auto& keys = score.candidate.cause->keys;
  const Eigen::VectorXd values = KeysOf(score).values;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const double value = values[k] / keys[k].unit;
    if (value < keys[k].least || value > keys[k].most) return &keys[k];
  }
  return nullptr;
}

}  // namespace abbe::diagnosis
