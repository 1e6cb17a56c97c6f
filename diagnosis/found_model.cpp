#include "diagnosis/found_model.h"

#include <cmath>

#include "standards/coverage.h"

namespace abbe::diagnosis {

simulation::ModelledCause FoundCause(const Score& score) {
  const auto [values, u] = KeysOf(score);
  const Eigen::Index count = score.coefficients.size();
  // A random field is known by its size, not by its values here.
  const Eigen::MatrixXd covariance = score.candidate.cause->IsRandomField()
                                         ? Eigen::MatrixXd{}
                                         : score.covariance.topLeftCorner(count, count).eval();
  return {score.candidate.cause, score.candidate.object, values, standards::kCoverage * u,
          covariance};
}

simulation::ExtendedModel FoundModel(const Diagnosis& diagnosis, const Campaign& campaign,
                                     const HeldOutGain& gain) {
  simulation::ExtendedModel model;
  model.machine = campaign.instruments().machine.name;
  model.origin = campaign.origin();
  model.gain = {gain.rows, gain.before, gain.after, std::sqrt(diagnosis.chi_before),
                std::sqrt(diagnosis.chi_after)};
  for (const Finding& finding : diagnosis.findings) {
    if (IsModelled(finding)) model.causes.push_back(FoundCause(finding.score));
  }
  return model;
}

}  // namespace abbe::diagnosis
