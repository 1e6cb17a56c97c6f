#include "investigate/choice.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "diagnosis/drawn_machine.h"
#include "diagnosis/expected_odds.h"
#include "diagnosis/linear_runs.h"
#include "diagnosis/run_catalogue.h"
#include "failure/failure.h"
#include "investigate/expected_information.h"
#include "investigate/worlds.h"
#include "random/counter_random.h"
#include "simulation/kinds.h"

namespace abbe::investigate {
namespace {

using diagnosis::Candidate;
using diagnosis::PossibleRun;
using diagnosis::RunSums;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::vector<PossibleRun> RunsAtHand(const Situation& situation) {
  auto possible = diagnosis::PossibleRuns(
      situation.campaign, situation.recordings, situation.about,
      [&](const simulation::RunKind& kind) {
        return situation.costs.at_hand.contains(std::string(kind.Instrument()));
      });
  std::erase_if(possible, [&](const PossibleRun& run) { return !situation.records(run.path); });
  if (possible.empty()) {
    throw InputError(
        "investigate: no run can be made with what is at hand; describe a head or a linkage in "
        "the machine file, or name the instruments by at_hand in [investigate]");
  }
  return possible;
}

// The machine that runs are simulated on.
diagnosis::Values MachineOf(const Situation& situation,
                            const std::vector<diagnosis::PreparedRun>& runs) {
  if (situation.now != nullptr) return diagnosis::ValuesOf(situation.now->fitted);
  constexpr std::uint64_t kSeed = 1, kStream = 0x91A8;
  const random::CounterRandom random(kSeed, kStream);
  std::uint64_t index = 0;
  return diagnosis::DrawnMachine(situation.campaign, runs, [&] { return random.Normal(index++); });
}

class Prospects {
 public:
  explicit Prospects(const Situation& situation)
      : situation_(situation),
        possible_(RunsAtHand(situation)),
        recorded_(situation.campaign.runs().size()),
        worlds_(
            WorldsOf(situation.now, SceneOf(situation, possible_),
                     diagnosis::CoarsenessOf(situation.campaign.instruments().machine.population))),
        runs_(AllRuns()),
        linear_(situation.campaign, runs_, MachineOf(situation, runs_)) {
    for (const World& world : worlds_.list) {
      if (!world.candidate) continue;
      candidates_.push_back(*world.candidate);
      coefficients_ += world.mean.size();
    }
    for (const Candidate& candidate : worlds_.certain) {
      candidates_.push_back(candidate);
      const Index before = others_.size();
      others_.conservativeResize(before + candidate.cause->coefficients());
      others_.tail(others_.size() - before) = candidate.Plausible();
    }
  }

  Choice Make() {
    std::vector<RunSums> recorded;
    for (std::size_t run = 0; run < recorded_; ++run) {
      recorded.push_back(linear_.SumsOf(linear_.At(run), candidates_));
    }
    std::vector<const RunSums*> runs = diagnosis::PointersTo(recorded);
    const MatrixXd before =
        runs.empty() ? MatrixXd::Zero(coefficients_, coefficients_) : InformationOf(runs);
    WeighBySilence(situation_.now, before, worlds_);
    Choice choice{.entropy = worlds_.Entropy()};
    std::vector<RunSums> all;
    for (std::size_t i = 0; i < possible_.size(); ++i) {
      try {
        all.push_back(linear_.SumsOf(linear_.At(recorded_ + i), candidates_));
      } catch (const NumericalError&) {
        continue;  // this machine cannot make the run
      }
      runs.push_back(&all.back());
      choice.weighed.push_back(Weigh(possible_[i], before, InformationOf(runs)));
      runs.pop_back();
    }
    // Where none promises anything, the one that costs least.
    std::ranges::stable_sort(choice.weighed, {},
                             [](const WeighedRun& run) { return run.minutes.total(); });
    std::ranges::stable_sort(choice.weighed, std::ranges::greater{}, &WeighedRun::bits_per_minute);
    for (const RunSums& each : all) runs.push_back(&each);
    DescribeWorlds(InformationOf(runs), choice);
    return choice;
  }

 private:
  static simulation::Scene SceneOf(const Situation& situation,
                                   const std::vector<PossibleRun>& possible) {
    simulation::Scene scene = situation.campaign.scene();
    for (const PossibleRun& each : possible) {
      if (each.run.trace.rows() > 0) scene.traces.push_back(&each.run.trace);
    }
    return scene;
  }

  std::vector<diagnosis::PreparedRun> AllRuns() const {
    std::vector<diagnosis::PreparedRun> runs = situation_.campaign.runs();
    for (const PossibleRun& each : possible_) runs.push_back(each.run);
    return runs;
  }

  MatrixXd InformationOf(const std::vector<const RunSums*>& runs) const {
    return diagnosis::FreeOfOthers(linear_.Information(runs), coefficients_, others_);
  }

  WeighedRun Weigh(const PossibleRun& possible, const MatrixXd& before,
                   const MatrixXd& after) const {
    const double waiting =
        std::max(0.0, simulation::StartedOf(possible.path) - situation_.about.started);
    const auto made = std::ranges::count(situation_.made, possible.text);
    const double bits = std::ldexp(ExpectedInformation(before, after, worlds_.list),
                                   -static_cast<int>(made) - situation_.stalled);
    return {possible.text, CostOf(possible.path, situation_.place, waiting, situation_.costs),
            std::max(0.0, bits), possible.path};
  }

  // `all`: of everything together.
  void DescribeWorlds(const MatrixXd& all, Choice& choice) const {
    constexpr std::size_t kTold = 8;
    std::map<std::string, double> groups;
    double shown = 0.0;
    Index first = 0;
    for (const World& world : worlds_.list) {
      groups[world.group] += world.probability;
      const Index count = world.mean.size();
      if (!world.candidate || IsShown(world, all.diagonal().segment(first, count))) {
        shown += world.probability;
      } else if (world.group != kUnknown) {
        choice.never_shown.push_back(world.name);
      }
      first += count;
    }
    choice.nothing = shown > 0.0 ? worlds_.list.front().probability / shown : 0.0;
    for (const auto& [name, probability] : groups) choice.worlds.push_back({name, probability});
    std::ranges::stable_sort(choice.worlds, std::ranges::greater{}, &Probable::probability);
    if (choice.worlds.size() > kTold) choice.worlds.resize(kTold);
  }

  static bool IsShown(const World& world, const VectorXd& information) {
    const VectorXd size = world.candidate->cause->IsBinary() ? VectorXd::Ones(information.size())
                                                             : world.candidate->Plausible();
    return size.cwiseProduct(information.cwiseMax(0.0).cwiseSqrt()).norm() >= diagnosis::kShowable;
  }

  const Situation& situation_;
  std::vector<PossibleRun> possible_;
  std::size_t recorded_;
  Worlds worlds_;
  std::vector<diagnosis::PreparedRun> runs_;
  diagnosis::LinearRuns linear_;
  std::vector<Candidate> candidates_;
  Index coefficients_ = 0;
  VectorXd others_;
};

}  // namespace

Choice Choose(const Situation& situation) { return Prospects(situation).Make(); }

}  // namespace abbe::investigate
