#include "investigate/investigation.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "diagnosis/doubts.h"
#include "diagnosis/measured_noise.h"
#include "failure/failure.h"
#include "recording/recording_file.h"
#include "simulation/kinds.h"

namespace abbe::investigate {
namespace {

using diagnosis::Verdict;
using recording::Recording;

// All recordings so far, diagnosed together.
struct Diagnosed {
  diagnosis::Campaign campaign;
  std::optional<diagnosis::Diagnosis> diagnosis;
  diagnosis::HeldOutGain gain = {};
};

diagnosis::Campaign CampaignOf(const std::vector<Recording>& recordings,
                               simulation::Instruments instruments) {
  diagnosis::UseMeasuredNoise(recordings, instruments);
  diagnosis::Campaign campaign(std::move(instruments));
  campaign.Add(recordings);
  return campaign;
}

void HoldOut(const std::vector<Recording>& recordings, Diagnosed& all) {
  std::vector<diagnosis::Candidate> causes;
  for (const diagnosis::Finding& finding : all.diagnosis->findings) {
    if (diagnosis::IsModelled(finding)) causes.push_back(finding.score.candidate);
  }
  if (causes.empty()) return;
  try {
    all.gain = diagnosis::HoldOut(all.campaign, recordings, causes);
    diagnosis::AddDoubtsOfHeldOut(all.gain, *all.diagnosis);
  } catch (const NumericalError&) {
    // Half of the runs do not suffice for a fit: nothing is held out.
  }
}

Diagnosed DiagnosisOf(const std::vector<Recording>& recordings, const Subject& subject) {
  Diagnosed all{CampaignOf(recordings, subject.instruments), {}};
  if (recordings.empty()) return all;
  all.diagnosis = diagnosis::Diagnose(all.campaign);
  all.campaign = diagnosis::CampaignOf(*all.diagnosis, diagnosis::Campaign(all.campaign));
  if (all.diagnosis->verdict == Verdict::kExplained) HoldOut(recordings, all);
  return all;
}

// Whether one channel was left over one variable by the last run too.
bool IsLeftAgain(const Outcome& now, const Outcome& last) {
  return std::ranges::any_of(now.left, [&](const std::string& left) {
    return std::ranges::find(last.left, left) != last.left.end();
  });
}

bool IsCertain(const diagnosis::Diagnosis& diagnosis, const Choice& choice) {
  switch (diagnosis.verdict) {
    case Verdict::kExplained:
      return true;
    case Verdict::kClean:
      return choice.nothing >= diagnosis::kCertain;
    default:
      return false;
  }
}

class Investigator {
 public:
  Investigator(const Subject& subject, Recorder& recorder, Journal& journal,
               const std::function<void(const std::string&)>& show)
      : subject_(subject), recorder_(recorder), journal_(journal), show_(show) {
    for (const auto& path : journal.recordings()) Take(recording::Read(path));
  }

  Ended Run() {
    if (journal_.IsEnded()) journal_.Reopen();
    if (journal_.IsWaiting() && !RecordWaiting()) return End(Why::kWaiting, nullptr);
    while (true) {
      const Diagnosed now = DiagnosisOf(recordings_, subject_);
      diagnosis_ = now.diagnosis;
      gain_ = now.gain;
      const Choice choice = ChoiceAfter(now);
      if (diagnosis_) Note(choice);
      if (const auto why = WhyToEnd(choice)) return End(*why, &choice);
      Decide(choice);
      if (!RecordWaiting()) return End(Why::kWaiting, nullptr);
    }
  }

 private:
  void Take(Recording recording) {
    place_ = PlaceOf(recording);
    const double ended = simulation::StartedOf(recording) + simulation::DurationOf(recording);
    clock_ = std::max(clock_, ended);
    for (const auto& column : recording.columns) {
      if (column.name.starts_with("temp_") && !column.values.empty()) {
        temperature_[column.name] = column.values.back();
      }
    }
    recordings_.push_back(std::move(recording));
  }

  Choice ChoiceAfter(const Diagnosed& now) const {
    simulation::PathAbout about{subject_.instruments.machine.name,
                                std::max(clock_, journal_.started()), temperature_};
    for (const std::string& sensor : subject_.sensors) {
      about.temperature.try_emplace(sensor, subject_.room);
    }
    return Choose({now.campaign, recordings_, diagnosis_ ? &*diagnosis_ : nullptr, place_,
                   subject_.costs, about, journal_.texts(), journal_.stalled(),
                   [&](const Recording& path) { return recorder_.Records(path); }});
  }

  void Note(const Choice& choice) {
    std::vector<Outcome> before = journal_.outcomes();
    // A step that was diagnosed before an interruption is diagnosed again, and the same.
    if (before.size() == recordings_.size()) before.pop_back();
    Outcome outcome = OutcomeOf(*diagnosis_);
    outcome.is_certain = IsCertain(*diagnosis_, choice);
    certain_ = outcome.is_certain;
    left_again_ = !before.empty() && IsLeftAgain(outcome, before.back());
    journal_.Diagnosed(outcome, &choice);
    Show(fmt::format("  {}{}", outcome.verdict, certain_ ? ", certain" : ""));
  }

  std::optional<Why> WhyToEnd(const Choice& choice) const {
    if (certain_) return Why::kCertain;
    if (left_again_) return Why::kLeftAgain;
    const bool is_left = diagnosis_ && diagnosis_->verdict == Verdict::kUnexplained;
    const WeighedRun& best = choice.weighed.front();
    // What is left unexplained once is asked for again.
    if (best.bits < subject_.least_bits && !(is_left && !WasLeftBefore())) {
      return Why::kNothingMore;
    }
    if (journal_.spent() + best.minutes.total() > subject_.budget) return Why::kBudget;
    return {};
  }

  bool WasLeftBefore() const {
    const auto all = journal_.outcomes();
    return all.size() > 1 && all[all.size() - 2].verdict == Name(Verdict::kUnexplained);
  }

  // The run begins when it is set up.
  void Decide(Choice choice) {
    WeighedRun& best = choice.weighed.front();
    const double planned = simulation::StartedOf(best.path) + kMinute * best.minutes.set_up;
    best.path = simulation::BegunAt(std::move(best.path), recorder_.Begin(planned));
    journal_.Decide(choice);
    Show(fmt::format("{}. {} ({:.1f} min, {:.3f} bits)", journal_.number(), best.text,
                     best.minutes.total(), best.bits));
  }

  bool RecordWaiting() {
    const auto file = recorder_.Record(recording::Read(journal_.WaitingPath()), journal_);
    if (!file) return false;
    Take(recording::Read(journal_.folder() / *file));
    journal_.Recorded(*file);
    return true;
  }

  Ended End(Why why, const Choice* choice) {
    if (why != Why::kWaiting) journal_.End(Text(why), choice);
    return {why, std::move(recordings_), std::move(diagnosis_), gain_};
  }

  void Show(const std::string& line) const {
    if (show_) show_(line);
  }

  const Subject& subject_;
  Recorder& recorder_;
  Journal& journal_;
  const std::function<void(const std::string&)>& show_;
  std::vector<Recording> recordings_;
  std::map<std::string, double> temperature_;
  Place place_;
  double clock_ = 0.0;
  std::optional<diagnosis::Diagnosis> diagnosis_;
  diagnosis::HeldOutGain gain_;
  bool certain_ = false, left_again_ = false;
};

}  // namespace

std::string Text(Why why) {
  switch (why) {
    case Why::kCertain:
      return "the verdict is certain";
    case Why::kLeftAgain:
      return "a further run leaves the same unexplained";
    case Why::kNothingMore:
      return "no run promises more";
    case Why::kBudget:
      return "the next run is beyond the budget";
    case Why::kWaiting:
      return "a run waits to be recorded";
  }
  return {};
}

Ended Investigate(const Subject& subject, Recorder& recorder, Journal& journal,
                  const std::function<void(const std::string&)>& show) {
  return Investigator(subject, recorder, journal, show).Run();
}

}  // namespace abbe::investigate
