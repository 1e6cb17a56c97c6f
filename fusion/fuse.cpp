#include "fusion/fuse.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "estimation/linearization.h"
#include "failure/progress.h"
#include "fusion/fused_state.h"
#include "fusion/plate_form.h"
#include "fusion/reversals.h"
#include "fusion/row_memory.h"
#include "fusion/target_form.h"
#include "settings/unit.h"
#include "simulation/linkage/linkage_problem.h"
#include "simulation/remembered_noise.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using estimation::Linearization;
using estimation::Problem;
using estimation::Result;
using simulation::SimulatedRun;

constexpr int kFits = 5;                // at most, until noise and knots have settled
constexpr double kNoiseSettled = 0.05;  // of its logarithm
// Standard uncertainties from the solution: of the last fit, and of those before it, whose priors
// and knots may be wrong.
constexpr double kSettled = 1e-4, kFirstLook = 0.03, kTolerated = 3.0;

void Widen(double times, SeenErrors& seen) {
  seen.covariance *= times * times;
  for (FunctionSeen& function : seen.functions) function.u *= times;
  seen.scale.u *= times;
}

// A problem with its solution and the information of every source there.
struct Fitted {
  Problem problem;
  Result fit = {};
  Linearization at = {};
};

class FuseJob {
 public:
  FuseJob(const machine::Machine& machine, std::vector<SimulatedRun> runs,
          const FuseOptions& options)
      : machine_(machine),
        runs_(std::move(runs)),
        options_(options),
        knots_(options.knots.value_or(KnotsOf(machine))),
        model_(UnknownMachine(machine, knots_)),
        population_(PopulationOf(machine)),
        noise_(runs_.size(), 1.0),
        memory_(runs_.size()) {
    AllowFormAndReversals();
  }

  FuseReport Run() {
    Steps steps(kFits + 1);
    steps.Begin("fit 1");
    Fitted now = Fit({}, options_.choose_smoothness);
    for (int fits = 1; fits < kFits; ++fits) {
      const Judged reversals = JudgeReversals(machine_, now.fit, runs_);
      Change change = reversals == Judged::kOtherSize ? Change::kNoise : Change::kNone;
      if (options_.choose_smoothness) {
        if (Remember(now)) change = Change::kNoise;
        change = std::max(change, Estimate(now, fits + 1 < kFits));
      }
      // Runs on new knots have nothing to be replaced by yet.
      const bool condensed = change != Change::kKnots && Condense(now.fit);
      if (!options_.choose_smoothness && !condensed && reversals == Judged::kAsBefore) break;
      const bool last = change == Change::kNone || fits + 1 == kFits;
      steps.Begin(fmt::format("fit {}", fits + 1));
      now = Fit(now.fit.blocks, options_.choose_smoothness && !last);
      if (last) break;
    }
    steps.Begin("the map");
    return Report(std::move(now));
  }

 private:
  // Starts at the values of `start` where they are of the same size, else at the nominal ones.
  Fitted Fit(const std::vector<estimation::ParameterBlock>& start, bool first_look) const {
    Fitted fitted{MakeProblem(runs_)};
    for (const auto& known : fitted.problem.blocks()) {
      const auto from = std::find_if(start.begin(), start.end(), [&](const auto& block) {
        return block.name == known.name && block.size() == known.size();
      });
      if (from == start.end()) continue;
      auto& entries = fitted.problem.Block(fitted.problem.Find(known.name)).entries;
      for (std::size_t i = 0; i < entries.size(); ++i) {
        if (!entries[i].held) entries[i].value = from->entries[i].value;
      }
    }
    fitted.fit =
        simulation::SolveLinkage(fitted.problem, options_.threads, false,
                                 first_look ? kFirstLook : kSettled, first_look ? kTolerated : 0.0);
    fitted.at = SumsAt(fitted.fit, fitted.problem);
    return fitted;
  }

  Linearization SumsAt(const Result& fit, const Problem& problem) const {
    return estimation::Linearize(problem, estimation::Layout(problem), ValuesFound(fit, fit.blocks),
                                 options_.threads);
  }

  // With the noise and the memory of each run.
  Problem MakeProblem(std::vector<SimulatedRun> runs) const {
    for (std::size_t r = 0; r < runs.size(); ++r) {
      if (!memory_[r]) continue;
      runs[r].residual = simulation::WithMemory(runs[r].residual, runs[r].times, *memory_[r]);
    }
    return MakeMachineProblem(machine_, model_, Prior(), runs, noise_);
  }

  // What goes on from row to row in each run, beside what a fit says; false where nothing changes.
  bool Remember(Fitted& now) {
    const Problem plain = MakeMachineProblem(machine_, model_, Prior(), runs_);
    const estimation::Layout layout(now.problem);  // reversals may be held since
    const VectorXd x = ValuesFound(now.fit, now.fit.blocks);
    bool changed = false;
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      const RowMemory found = FindRowMemory(plain, layout, x, now.at, r, runs_[r].times);
      changed |= TakeUp(found, noise_[r], memory_[r]);
    }
    if (!changed) return false;
    now.problem = MakeProblem(runs_);
    now.at = SumsAt(now.fit, now.problem);
    return true;
  }

  void AllowFormAndReversals() {
    for (SimulatedRun& run : runs_) {
      WithForm(run);
      SetForm(form_, run);
      WithReversals(machine_, run);
    }
  }

  MachinePrior Prior() const { return {machine_, model_, population_}; }

  // Replaces the residuals that need a first fit; false when there are none.
  bool Condense(const Result& fit) {
    bool any = false;
    for (SimulatedRun& run : runs_) {
      if (!run.condense) continue;
      run.residual = run.condense(ValuesFound(fit, run.blocks));
      run.condense = nullptr;
      any = true;
    }
    return any;
  }

  // What another fit has to settle, the least first.
  enum class Change { kNone, kNoise, kKnots };

  // Sizes, smoothness and noise from a fit. After knots have changed all of it is estimated anew.
  Change Estimate(const Fitted& now, bool may_refine) {
    const estimation::Layout layout(now.problem);
    std::vector<estimation::ParameterBlock> forms;
    LinearRuns runs{.prior = now.at.prior,
                    .runs = {},
                    .rows = {},
                    .noise = noise_,
                    .theta = theta_,
                    .squareness = population_.squareness,
                    .machine = ColumnsOf(layout.names, model_.Blocks()),
                    .form = {},
                    .form_stated = 0.0,
                    .form_known_to = 1.0,
                    .form_times = form_,
                    .values = ValuesFound(now.fit, model_.Blocks()),
                    .form_values = {}};
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      runs.runs.push_back(now.at.sources[r]);
      runs.rows.push_back(now.problem.sources()[r].rows);
      runs.form_stated = std::max(runs.form_stated, runs_[r].form_stated);
      runs.form_known_to = std::max(runs.form_known_to, runs_[r].form_known_to);
    }
    std::copy_if(now.fit.blocks.begin(), now.fit.blocks.end(), std::back_inserter(forms), IsForm);
    runs.form = ColumnsOf(layout.names, forms);
    runs.form_values = ValuesFound(now.fit, forms);
    PopulationEstimate seen = EstimatePopulation(machine_, model_, runs);
    bool noise = false;
    for (std::size_t r = 0; r < noise_.size(); ++r) {
      noise = noise || std::abs(std::log(seen.noise[r] / noise_[r])) > kNoiseSettled;
    }
    population_ = seen.population;
    theta_ = std::move(seen.theta);
    noise_ = std::move(seen.noise);
    if (std::abs(std::log(seen.form / form_)) > kNoiseSettled) noise = true;
    form_ = seen.form;
    for (SimulatedRun& run : runs_) SetForm(form_, run);
    statements_ = std::move(seen.statements);
    if (SetHoles(now.fit)) noise = true;
    by_theta_ = std::move(seen.by_theta);
    seen_ = std::move(seen.seen);
    if (may_refine && Refine()) return Change::kKnots;
    return noise ? Change::kNoise : Change::kNone;
  }

  // The form of a plate; false where it has settled.
  bool SetHoles(const Result& fit) {
    const PlateForm found = EstimatePlateForm(fit, runs_, holes_);
    if (found.stated == 0.0) return false;
    statements_.push_back({.key = kPlateFormKey,
                           .unit = settings::kMicro,
                           .stated = found.stated,
                           .seen = found.times * found.stated,
                           .u_log = found.u_log});
    const double before = std::exchange(holes_, found.times);
    SetPlateForm(holes_, before, runs_);
    return std::abs(std::log(holes_ / before)) > kNoiseSettled;
  }

  // Waves where a run can show them, then finer knots where a function needs them; false where none
  // does.
  bool Refine() {
    if (!options_.runs_on) return false;
    if (const auto may_show = ThatMayShowWaves(runs_); waves_ != may_show) {
      waves_ = may_show;
      const PopulationEvidence evidence(machine_, WithWaves(model_, waves_));
      VectorXd usual = VectorXd::Zero(evidence.count());  // the waves
      usual.head(theta_.size()) = theta_;
      theta_ = std::move(usual);
      population_ = evidence.PopulationAt(theta_);
    } else {
      const auto finer = KnotsFor(machine_, population_, knots_);
      if (finer == knots_) return false;
      knots_ = finer;
    }
    model_ = WithWaves(UnknownMachine(machine_, knots_), waves_);
    // More of it may have been what the model could not follow.
    noise_.assign(noise_.size(), 1.0);
    memory_.assign(memory_.size(), std::nullopt);
    runs_ = options_.runs_on(model_);
    SetPlateForm(holes_, 1.0, runs_);
    AllowFormAndReversals();
    return true;
  }

  FuseReport Report(Fitted now) {
    machine::VolumetricModel found = model_;
    found.SetParameters(ValuesFound(now.fit, model_.Blocks()));
    SeenErrors seen =
        SeeErrors(machine_, found, runs_,
                  ColumnsOf(estimation::Layout(now.problem).names, model_.Blocks()), now.at);
    std::vector<RunConsistency> consistency = CheckRuns(now.problem, now.at);
    const int contradicting = Contradicting(consistency);
    const double widened = contradicting < 0 ? 1.0 : BirgeRatio(consistency[contradicting]);
    Widen(widened, seen);
    if (by_theta_.size() > 0) seen.covariance += by_theta_ * by_theta_.transpose();
    AddDoubt(options_.doubt, found, -machine_.reference, seen.covariance);
    const MachinePrior prior = Prior();
    const auto evident = theta_.size() > 0
                             ? PopulationEvidence(machine_, model_).EvidentWaves(seen_, theta_)
                             : std::array<bool, machine::kAxes>{};
    std::vector<PlaceScatter> scatter;
    std::vector<double> follows;
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      follows.push_back(CorrelationIn(Left(now, r)));
      scatter.push_back(FindPlaceScatter(runs_[r], AsStated(now, r), found, prior, evident));
    }
    CountScatter(scatter, found, seen);
    FuseReport report{.map = MapOf(now, found, seen)};
    report.functions = std::move(seen.functions);
    report.scale = seen.scale;
    report.chosen_smoothness = SmoothnessSeen();
    report.statements = std::move(statements_);
    report.seen = std::move(seen_);
    report.noise = noise_;
    report.memory = memory_;
    for (std::size_t r = 0; r < memory_.size(); ++r) {
      if (!memory_[r]) continue;
      report.memory[r]->slow *= noise_[r];
      report.noise[r] *= memory_[r]->white;
    }
    report.reversals = ReversalsOf(now.fit, widened);
    for (const SimulatedRun& run : runs_) {
      report.kinds.push_back(run.kind);
      for (const std::string& note : run.notes) report.notes.push_back(run.name + ": " + note);
    }
    report.runs = std::move(consistency);
    report.scatter = std::move(scatter);
    report.follows = std::move(follows);
    report.contradicting = contradicting;
    report.widened = widened;
    if (contradicting >= 0) {
      report.suspect = SuspectOf(contradicting, now.fit);
      report.may_be_wrong = MayBeWrong(now.problem, now.at);
    }
    if (options_.holdout > 0) {
      Steps steps(1);
      steps.Begin("blocks of rows held out");
      report.held_out =
          HoldOut(options_.holdout, runs_, [&](const auto& runs) { return MakeProblem(runs); });
    }
    report.fit = std::move(now.fit);
    return report;
  }

  // What, if the run had it of its own, would make it agree with the others.
  Suspect SuspectOf(std::size_t run, const Result& found) {
    const auto agrees = [&](Suspect suspect) {
      auto own = BlocksOfItsOwn(runs_, run, suspect, model_);
      if (!own) return false;
      std::swap(runs_[run].blocks, *own);
      const Fitted apart = Fit(found.blocks, true);
      std::swap(runs_[run].blocks, *own);
      return Contradicting(CheckRuns(apart.problem, apart.at)) != static_cast<int>(run);
    };
    for (const Suspect suspect : {Suspect::kMounting, Suspect::kInstrument}) {
      if (agrees(suspect)) return suspect;
    }
    return Suspect::kNone;
  }

  // What a fit leaves of a run, whitened.
  VectorXd Left(const Fitted& now, std::size_t run) const {
    VectorXd left;
    const estimation::Layout layout(now.problem);
    const VectorXd x = ValuesFound(now.fit, now.fit.blocks);
    for (const auto& term : now.problem.terms()) {
      if (term.source.index != static_cast<int>(run)) continue;
      estimation::RowEvaluator rows(now.problem, layout);
      const auto* found = rows.Evaluate(term, x, false);
      if (found == nullptr) continue;
      left.conservativeResize(left.size() + found->r.size());
      left.tail(found->r.size()) = found->r;
    }
    return left;
  }

  // The same, whitened as the noise is stated.
  VectorXd AsStated(const Fitted& now, std::size_t run) const {
    VectorXd left(runs_[run].residual->Rows());
    runs_[run].residual->Evaluate(ValuesFound(now.fit, runs_[run].blocks), left, nullptr);
    return left;
  }

  double SmoothnessSeen() const {
    for (const Statement& each : statements_) {
      if (each.key == kSmoothnessKey) return each.seen;
    }
    return machine_.population.smoothness;
  }

  map::ErrorMap MapOf(const Fitted& now, const machine::VolumetricModel& found,
                      const SeenErrors& seen) const {
    map::MapOrigin origin;
    origin.machine = machine_.name;
    origin.reference = machine_.reference;
    origin.tool = -machine_.reference;
    origin.scale_is_calibrated = seen.scale.calibrated;
    origin.limits = machine_.limits;
    for (std::size_t error = 0; error < seen.functions.size(); ++error) {
      const auto& by = seen.functions[error].determined_by;
      if (!by.empty()) origin.sources[error] = by.front();
    }
    std::optional<map::MapState> state;
    if (options_.measured > 0.0) {
      state = StateAfter(now.fit, estimation::Layout(now.problem), now.at, model_.Blocks(), runs_,
                         seen.covariance);
      state->time = options_.measured;
      state->sensors = options_.sensors;
    }
    return {origin, found, seen.covariance, std::move(state)};
  }

  const machine::Machine& machine_;
  std::vector<SimulatedRun> runs_;
  const FuseOptions options_;
  std::array<double, machine::kAxes> knots_;  // m apart, of model_
  machine::VolumetricModel model_;
  ErrorPopulation population_;
  std::array<bool, machine::kAxes> waves_{};  // the axes that have any in model_
  VectorXd theta_;                            // population_estimate.h
  std::vector<double> noise_;
  std::vector<std::optional<estimation::NoiseMemory>> memory_;  // of each run, over what is stated
  double form_ = 1.0;   // of the target, over what the file states
  double holes_ = 1.0;  // of the form of a plate, the same
  std::vector<Statement> statements_;
  Eigen::MatrixXd by_theta_;  // population_estimate.h
  Quadratic seen_;            // the same
};

}  // namespace

FuseReport Fuse(const machine::Machine& machine, const std::vector<SimulatedRun>& runs,
                const FuseOptions& options) {
  return FuseJob(machine, runs, options).Run();
}

}  // namespace abbe::fusion
