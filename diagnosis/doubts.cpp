#include "diagnosis/doubts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "standards/coverage.h"
#include "standards/deviation_of_draws.h"

namespace abbe::diagnosis {
namespace {

using Eigen::Index;

// Whether zero lies within U95 of the coefficients, all of them together.
bool IsWithinItsUncertainty(const Finding& finding) {
  const Candidate& candidate = finding.score.candidate;
  const Index count = finding.score.coefficients.size();
  if (candidate.cause->IsBinary() || count == 0) return false;
  if (candidate.cause->IsRandomField()) {  // of one draw nobody knows whether there are more
    constexpr double kFewest = 1.5;
    const Keys keys = KeysOf(finding.score);
    return standards::DeviationOfDraws(kFewest).u95 * std::abs(keys.values[0]) <
           standards::kCoverage * keys.u[0];
  }
  const Eigen::MatrixXd covariance = finding.score.covariance.topLeftCorner(count, count);
  if (covariance.isZero(0.0)) return false;
  const double square =
      finding.score.coefficients.dot(covariance.ldlt().solve(finding.score.coefficients));
  return square < standards::kCoverage * standards::kCoverage * count;
}

// Between neighbouring places of an axis, m: the median of each run, the least of all runs.
double StepOf(const simulation::Scene& scene, int axis) {
  constexpr double kSamePlace = 1e-6;  // m
  double least = std::numeric_limits<double>::infinity();
  for (const simulation::Trace* trace : scene.traces) {
    if (trace->axes.cols() < 3) continue;
    std::vector<double> places(trace->axes.row(axis).begin(), trace->axes.row(axis).end());
    std::sort(places.begin(), places.end());
    std::vector<double> steps;
    for (std::size_t i = 1; i < places.size(); ++i) {
      if (places[i] - places[i - 1] > kSamePlace) steps.push_back(places[i] - places[i - 1]);
    }
    if (steps.size() < 2) continue;
    const auto middle = steps.begin() + (steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    least = std::min(least, *middle);
  }
  return least;
}

// The period along an axis, m; 0: it has none.
double PeriodOf(const Finding& finding) {
  const Candidate& candidate = finding.score.candidate;
  const auto& keys = candidate.cause->keys;
  const auto pitch = std::ranges::find(keys, "pitch_mm", &simulation::CauseKey::name);
  if (pitch == keys.end()) return 0.0;
  return KeysOf(finding.score).values[pitch - keys.begin()];
}

// Readings that stand out in several channels of an instrument are hardly broken one by one.
bool AreOutliersOfSeveral(const Finding& finding, const std::vector<Finding>& findings) {
  const auto are = [&](const Finding& each) {
    return each.score.candidate.cause->id == "outliers" &&
           each.score.candidate.object.kind() == finding.score.candidate.object.kind();
  };
  return are(finding) && std::ranges::count_if(findings, are) > 1;
}

// What would tell waves, or instants, apart that the sampling shows alike.
std::string OneOfThese(const Score& score) {
  const simulation::Cause& cause = *score.candidate.cause;
  if (cause.one_event) {
    return fmt::format(
        "the recordings show {} instants of its kind alike; a run without a pause "
        "tells which it is, should it come again",
        score.one_of.size());
  }
  const auto slower = [](const Score& a, const Score& b) {
    return a.candidate.shape[0] < b.candidate.shape[0];
  };
  const double least = std::ranges::min(score.one_of, slower).candidate.shape[0],
               most = std::ranges::max(score.one_of, slower).candidate.shape[0];
  constexpr double kReadings = 4.0;  // of the fastest wave
  std::string tell =
      fmt::format("a standstill with a reading every {:.2g} ms", 1e3 / (kReadings * most));
  if (cause.wave && cause.wave->shape == simulation::Wave::Shape::kPeriod) {
    tell = fmt::format("a run with a reading every {:.2g} mm", 1e3 * least / kReadings);
  } else if (cause.wave && cause.wave->shape == simulation::Wave::Shape::kOrder) {
    tell = fmt::format("a slow turn with a reading every {:.2g} mrad",
                       1e3 * 2.0 * std::numbers::pi / (kReadings * most));
  }
  return fmt::format("the sampling of the runs shows {} of its kind alike; {} tells which it is",
                     score.one_of.size(), tell);
}

void Doubt(Finding& finding, std::string why, Diagnosis& diagnosis) {
  finding.doubts.push_back(std::move(why));
  finding.probability = std::min(finding.probability, kDoubtful);
  if (diagnosis.verdict == Verdict::kExplained) diagnosis.verdict = Verdict::kAmbiguous;
}

}  // namespace

void AddDoubts(const simulation::Scene& scene, Diagnosis& diagnosis) {
  for (Finding& finding : diagnosis.findings) {
    if (AreOutliersOfSeveral(finding, diagnosis.findings)) {
      Doubt(finding,
            "readings stand out in several channels: their noise has heavy tails, or something "
            "shook them all",
            diagnosis);
    }
    if (!IsModelled(finding)) continue;
    if (IsWithinItsUncertainty(finding)) Doubt(finding, "its U95 exceeds its size", diagnosis);
    if (const auto* key = BeyondBounds(finding.score)) {
      Doubt(finding,
            fmt::format("{} lies beyond what is physically possible ({:g} to {:g})", key->name,
                        key->least, key->most),
            diagnosis);
    }
    if (!finding.score.one_of.empty()) Doubt(finding, OneOfThese(finding.score), diagnosis);
    const double period = PeriodOf(finding);
    if (period <= 0.0) continue;
    const double step = StepOf(scene, finding.score.candidate.object.first());
    if (period < 2.0 * step) {
      Doubt(finding,
            fmt::format("its period is shorter than two steps of {:.3g} mm along the axis: other "
                        "periods fit as well; measure at steps of less than {:.3g} mm",
                        1e3 * step, 0.5e3 * period),
            diagnosis);
    }
  }
}

void AddDoubtsOfHeldOut(const HeldOutGain& gain, Diagnosis& diagnosis) {
  std::size_t modelled = 0;
  for (Finding& finding : diagnosis.findings) {
    if (!IsModelled(finding)) continue;
    const std::size_t place = modelled++;
    const simulation::Cause& cause = *finding.score.candidate.cause;
    if (place >= gain.without.size() || cause.one_event || cause.own_in_each_run) continue;
    if (gain.without[place].held < gain.after) {
      Doubt(finding,
            fmt::format("rows that were held out come out worse with it: rms {:.3f} instead of "
                        "{:.3f} of the stated noise",
                        gain.after, gain.without[place].held),
            diagnosis);
    }
  }
}

}  // namespace abbe::diagnosis
