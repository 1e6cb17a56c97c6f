#include "diagnosis/candidate.h"

#include <algorithm>
#include <cmath>

#include "simulation/causes/registry.h"

namespace abbe::diagnosis {

namespace {

// A length in the motion of an axis.
bool ScalesWith(const simulation::Cause& cause, const std::string& object) {
  return cause.SeatAt(object) != simulation::Seat::kInstrument &&
         std::any_of(cause.keys.begin(), cause.keys.end(),
                     [](const auto& key) { return key.name.ends_with("_um"); });
}

bool IsOfAxes(const std::string& object) { return object.find_first_of("XYZ") == 0; }

}  // namespace

double CoarsenessOf(const machine::Population& population) {
  constexpr double kFine = 2e-6;  // m
  return std::max(1.0, population.positioning / kFine);
}

std::vector<Candidate> AllCandidates(const simulation::Scene& scene, double coarseness) {
  std::vector<Candidate> candidates;
  for (const simulation::Cause& cause : simulation::Causes()) {
    const std::vector<Eigen::VectorXd> shapes =
        cause.shapes ? cause.shapes(scene) : std::vector<Eigen::VectorXd>{Eigen::VectorXd()};
    for (const std::string& object : cause.objects(scene)) {
      if (IsOfAxes(object) && scene.travel.isZero(0.0)) continue;
      const double own = ScalesWith(cause, object) ? coarseness : 1.0;
      for (const Eigen::VectorXd& shape : shapes) {
        candidates.push_back({&cause, object, shape, {}, own});
      }
    }
  }
  return candidates;
}

Keys KeysOf(const Score& score) {
  constexpr double kStep = 1e-3;  // standard uncertainties
  const auto values_at = [&](const Eigen::VectorXd& off) -> Eigen::VectorXd {
    const Eigen::Index count = score.coefficients.size();
    Eigen::VectorXd shape = score.candidate.shape;
    if (off.size() > count) shape *= std::exp(off[count]);
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

}  // namespace abbe::diagnosis
