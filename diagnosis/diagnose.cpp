#include "diagnosis/diagnose.h"

#include "diagnosis/search.h"
#include "simulation/excess_noise.h"

namespace abbe::diagnosis {
namespace {

// How much larger than stated the noise of each run is; 1 where the stated one is believed.
std::vector<double> ExcessOf(const Fit& fit) {
  std::vector<double> excess;
  const auto& runs = fit.campaign().runs();
  for (std::size_t r = 0; r < runs.size(); ++r) {
    excess.push_back(runs[r].EstimatesNoise() ? simulation::ExcessOf(fit.result().sources[r],
                                                                     fit.LeftOf(r), runs[r].excess)
                                              : 1.0);
  }
  return excess;
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
  }
  return "";
}

Diagnosis Diagnose(const Campaign& campaign) {
  if (!campaign.EstimatesNoise()) return Search(campaign).Run();
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
