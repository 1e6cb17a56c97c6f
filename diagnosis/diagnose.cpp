#include "diagnosis/diagnose.h"

#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "diagnosis/noise_hypothesis.h"
#include "diagnosis/population_hypothesis.h"
#include "diagnosis/search.h"
#include "diagnosis/stray_readings.h"
#include "failure/failure.h"
#include "simulation/excess_noise.h"

namespace abbe::diagnosis {
namespace {

// How many runs share what is left of this one.
double SharersOf(const Fit& fit, std::size_t run) {
  const auto& runs = fit.campaign().runs();
  double sharers = 1.0;
  for (std::size_t other = 0; other < runs.size(); ++other) {
    if (other == run || !runs[other].EstimatesNoise()) continue;
    const simulation::Trace &a = fit.TraceOf(run), &b = fit.TraceOf(other);
    if (a.mounting != b.mounting) continue;
    sharers += simulation::SharedLeft(a.linkage->angles, fit.LeftOf(run), b.linkage->angles,
                                      fit.LeftOf(other));
  }
  return sharers;
}

// How much larger than stated the noise of each run is; 1 where the stated one is believed.
std::vector<double> ExcessOf(const Fit& fit) {
  std::vector<double> excess;
  const auto& runs = fit.campaign().runs();
  for (std::size_t r = 0; r < runs.size(); ++r) {
    excess.push_back(1.0);
    if (!runs[r].EstimatesNoise()) continue;
    const double alone = simulation::ExcessOf(fit.result().sources[r], fit.LeftOf(r),
                                              runs[r].trace.time, runs[r].excess);
    if (alone > 1.0) excess.back() = alone * std::sqrt(SharersOf(fit, r));
  }
  return excess;
}

// With the causes alone taken in, for a structure may have followed an outlier.
std::vector<StrayReadings> StraysLeft(const Answer& answer) {
  std::vector<Candidate> causes;
  for (const Finding& finding : answer.diagnosis.findings) {
    if (IsModelled(finding)) causes.push_back(finding.score.candidate);
  }
  const Fit& base = answer.search->base();
  if (causes.empty()) return StrayReadingsOf(base);
  try {
    return StrayReadingsOf(Fit(base, std::move(causes)));
  } catch (const NumericalError&) {  // they need what is in no catalogue beside them
    return {};
  }
}

// What is left in the end may be outliers that only a fit shows.
Diagnosis WithoutStrays(std::shared_ptr<const Campaign> campaign) {
  constexpr int kRounds = 3;
  for (int round = 1;; ++round) {
    Answer answer = BesideMemory(BesidePopulation(campaign));
    if (answer.diagnosis.verdict != Verdict::kUnexplained || round == kRounds) {
      return std::move(answer.diagnosis);
    }
    const std::vector<StrayReadings> strays = StraysLeft(answer);
    if (strays.empty()) return std::move(answer.diagnosis);
    campaign = std::make_shared<const Campaign>(campaign->Without(strays));
  }
}

}  // namespace

bool IsModelled(const Finding& finding) {
  const simulation::Cause& cause = *finding.score.candidate.cause;
  return cause.columns || cause.relaxes;
}

std::string_view Name(Verdict verdict) {
  switch (verdict) {
    case Verdict::kClean:
      return "clean";
    case Verdict::kExplained:
      return "explained";
    case Verdict::kAmbiguous:
      return "ambiguous";
    case Verdict::kUnexplained:
      return "unexplained";
    case Verdict::kLearned:
      return "learned";
  }
  return "";
}

const Campaign& CampaignOf(const Diagnosis& diagnosis, const Campaign& given) {
  return diagnosis.campaign ? *diagnosis.campaign : given;
}

Diagnosis Diagnose(const Campaign& campaign) {
  if (!campaign.EstimatesNoise()) {
    return WithoutStrays(std::make_shared<const Campaign>(campaign));
  }
  Campaign noisy = campaign;
  // Runs that do not go together leave much more than each does alone.
  noisy.SetExcess(ExcessOf(Fit(noisy)), Campaign::Change::kUp);
  for (;;) {
    Search search(noisy);
    Diagnosis diagnosis = search.Run();
    // What was explained is noise of an arm no more: look again with what is left.
    if (!noisy.SetExcess(ExcessOf(search.fit()), Campaign::Change::kDown)) return diagnosis;
  }
}

}  // namespace abbe::diagnosis
