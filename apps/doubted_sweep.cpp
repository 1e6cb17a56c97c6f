#include "apps/doubted_sweep.h"

#include <algorithm>
#include <cmath>

#include "failure/failure.h"
#include "simulation/doubt.h"

namespace abbe::apps {
namespace {

using Eigen::VectorXd;
using probes::ComponentResult;
using probes::SweepResult;
using probes::Uncertain;
using simulation::WithDoubt;

// m: between two probes of one face, by whose difference an angle is measured.
double ShortestArm(const probes::HeadLayout<>& layout) {
  const auto lines = probes::LinesOf(layout);
  double arm = (lines[probes::kTopProbes].point - lines[probes::kTopProbes + 1].point).norm();
  for (std::size_t i = 0; i < probes::kTopProbes; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      arm = std::min(arm, (lines[i].point - lines[j].point).norm());
    }
  }
  return arm;
}

void Widen(Uncertain& number, const Uncertain& other, double left) {
  number.u = WithDoubt(number.u, number.value - other.value, left);
}

void Widen(const VectorXd& value, const VectorXd& other, double left, VectorXd& u) {
  if (value.size() != other.size()) {
    throw InputError(
        "a cause that is not certain changes which stations have readings, so no U95 can be "
        "stated; diagnose until it is certain");
  }
  for (Eigen::Index i = 0; i < u.size(); ++i) u[i] = WithDoubt(u[i], value[i] - other[i], left);
}

void Widen(ComponentResult& result, const ComponentResult& other, double displacement,
           double angle) {
  const double left = result.component.angle() ? angle : displacement;
  Widen(result.value, other.value, left, result.u);
  Widen(result.at_target, other.at_target, left, result.u_at_target);
  if (result.reversal && other.reversal) {
    Widen(result.reversal->value, other.reversal->value, left, result.reversal->u);
    Widen(result.reversal->mean, other.reversal->mean, left);
    Widen(result.reversal->largest, other.reversal->largest, left);
    result.reversal->seen = result.reversal->seen && std::abs(result.reversal->mean.value) >
                                                         result.coverage * result.reversal->mean.u;
  }
  if (result.range && other.range) Widen(*result.range, *other.range, left);
  if (result.straightness && other.straightness) {
    auto& mine = *result.straightness;
    mine.u =
        WithDoubt(mine.u, mine.least_squares.error - other.straightness->least_squares.error, left);
    Widen(mine.slope, other.straightness->slope, angle);
  }
}

}  // namespace

SweepResult ReduceCorrected(const recording::Recording& recording, const probes::SweepSetup& setup,
                            CauseCorrection& causes) {
  SweepResult result = probes::ReduceSweep(causes.Take(recording), setup);
  if (!causes.WidensU95()) return result;
  const SweepResult other = probes::ReduceSweep(causes.TakeCertain(recording), setup);
  const double angle = causes.unexplained() / ShortestArm(setup.head.layout);
  for (std::size_t i = 0; i < result.components.size(); ++i) {
    Widen(result.components[i], other.components[i], causes.unexplained(), angle);
  }
  return result;
}

}  // namespace abbe::apps
