#include "learned/explain.h"

#include <utility>

#include "diagnosis/doubts.h"
#include "diagnosis/found_model.h"
#include "diagnosis/measured_noise.h"
#include "diagnosis/next_run.h"
#include "failure/progress.h"
#include "simulation/kinds.h"

namespace abbe::learned {
namespace {

using recording::Recording;

void RefuseStrangers(const std::vector<Recording>& recordings,
                     const simulation::Instruments& instruments) {
  std::vector<simulation::RunSource> sources;
  sources.reserve(recordings.size());
  for (const Recording& each : recordings) sources.push_back(simulation::SourceOf(each));
  simulation::RefuseStrangers(sources, instruments);
}

std::vector<diagnosis::Candidate> ModelledCauses(const diagnosis::Diagnosis& diagnosis) {
  std::vector<diagnosis::Candidate> causes;
  for (const auto& finding : diagnosis.findings) {
    if (diagnosis::IsModelled(finding)) causes.push_back(finding.score.candidate);
  }
  return causes;
}

}  // namespace

std::vector<std::string> Explanation::Notes() const {
  std::vector<std::string> notes = campaign->notes();
  notes.insert(notes.end(), diagnosis.notes.begin(), diagnosis.notes.end());
  return notes;
}

simulation::ExtendedModel ModelOf(const Explanation& all) {
  simulation::ExtendedModel model = diagnosis::FoundModel(all.diagnosis, all.found(), all.gain);
  for (const Learned& term : all.learning.terms) {
    if (term.IsFound()) model.causes.push_back(simulation::ModelledTerm(term.term()));
  }
  return model;
}

Explanation Explain(const std::vector<Recording>& recordings, simulation::Instruments instruments,
                    const ExplainOptions& options) {
  // The runs, the search, the next runs, rows held out, and what is learned.
  Steps steps(options.learn ? 5 : 4);
  RefuseStrangers(recordings, instruments);
  diagnosis::UseMeasuredNoise(recordings, instruments);
  Explanation all{std::make_shared<diagnosis::Campaign>(std::move(instruments)), {}};
  steps.Begin("simulating the runs");
  all.campaign->Add(recordings);
  all.campaign->CarryOn(options.carried);
  steps.Begin("looking for causes");
  all.diagnosis = diagnosis::Diagnose(*all.campaign);
  steps.Begin("planning further runs");
  diagnosis::AddNextRuns(all.found(), recordings, all.diagnosis);
  const auto causes = ModelledCauses(all.diagnosis);
  if (options.learn) {
    steps.Begin("learning what is left");
    all.learning = Learn(all.diagnosis);
  }
  steps.Begin("holding rows out");
  std::string why_not;
  all.gain = diagnosis::HoldOutWhereTheySuffice(
      all.found(), recordings, all.learning.IsToBeDecided() ? all.learning.Candidates() : causes,
      why_not);
  if (!why_not.empty()) all.why_no_gain = why_not;
  diagnosis::AddDoubtsOfHeldOut(all.gain, all.diagnosis);
  Decide(all.gain, all.learning, all.diagnosis);
  return all;
}

}  // namespace abbe::learned
