#include "fusion/arm_calibration.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "estimation/problem.h"
#include "failure/failure.h"
#include "fusion/arm_discrepancy.h"
#include "fusion/contradiction.h"
#include "fusion/machine_problem.h"
#include "simulation/arm/arm_baseline.h"
#include "simulation/arm/arm_run.h"
#include "simulation/excess_noise.h"
#include "simulation/linkage/linkage_problem.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::VectorXd;
using estimation::Result;
using relm::WrittenChain;
using simulation::ArmBaseline;
using simulation::LinkageRun;
using simulation::LinkageSimulation;
using simulation::SimulatedRun;

constexpr double kArmSettled = 1e-3;  // standard uncertainties

// Nothing but geometry, which is all that rows hold.
relm::LinkageSettings GeometryOf(relm::LinkageSettings settings) {
  auto& tolerance = settings.tolerance;
  tolerance.eccentricity = tolerance.graduation = tolerance.bearing = 0.0;
  tolerance.compliance = tolerance.weight = tolerance.thermal = 0.0;
  return settings;
}

struct FittedRun {
  LinkageRun kept, recorded;  // without and with causes
  ArmBaseline baseline;
  Index left_out;
  SimulatedRun simulated;
};

LinkageRun WithoutPoses(const LinkageRun& run, const std::vector<Index>& out) {
  std::vector<Index> kept;
  for (Index pose = 0; pose < run.poses(); ++pose) {
    if (!std::binary_search(out.begin(), out.end(), pose)) kept.push_back(pose);
  }
  return Selection(run, kept);
}

class ArmJob {
 public:
  ArmJob(const relm::LinkageSettings& settings, const std::vector<ArmPoses>& runs)
      : settings_(settings), nominal_(WrittenChain::Of(settings)) {
    if (runs.empty()) throw InputError("no recording of an arm; name at least one");
    for (const ArmPoses& run : runs) Add(run);
    fit_ = Fit(false);
    RefusePoor();
    if (RaiseNoise()) fit_ = Fit(false);
    RefuseContradiction(fit_, 1.0);
    before_ = Fit(true);
    AddDiscrepancy();
  }

  ArmCalibration Found(const std::vector<ArmPoses>& runs, const std::vector<ArmPoses>& tests) {
    ArmCalibration found{nominal_, WrittenBy(fit_, ""), {}, {}, {}, {}};
    found.no_noise = no_noise_;
    found.u95 = Uncertainties(found);
    for (const FittedRun& run : fitted_) {
      found.excess = std::max(found.excess, run.baseline.excess);
      const std::string& ball = run.kept.ball;
      const auto known = [&](const auto& other) { return other.first == ball; };
      if (ball.empty() || std::any_of(found.balls.begin(), found.balls.end(), known)) continue;
      found.balls.emplace_back(ball, WrittenBy(fit_, ball).ball);
    }
    for (const ArmPoses& run : runs) found.runs.push_back(FiguresOf(run));
    for (const ArmPoses& test : tests) found.tests.push_back(FiguresOf(test));
    return found;
  }

 private:
  void Add(const ArmPoses& run) {
    const FittedRun* same = nullptr;
    for (const FittedRun& other : fitted_) {
      if (other.kept.mounting == run.corrected.mounting) same = &other;
    }
    const relm::LinkageSettings placed = GeometryOf(HeldAtOnePlace(
        same ? same->baseline.settings : Placed(settings_, run.corrected), run.corrected));
    const ArmBaseline baseline = FitArm(run.corrected, placed);
    const auto far = FarOff(run.corrected, baseline);
    const LinkageRun kept = WithoutPoses(run.corrected, far);
    fitted_.push_back(
        {kept, WithoutPoses(run.recorded, far), baseline, std::ssize(far),
         SimulateArm(simulation::ArmSimulation(placed), kept, baseline.x, baseline.excess)});
  }

  // `placed`: the geometry stays, but for where instrument and further balls stand.
  Result Fit(bool placed) const {
    std::vector<SimulatedRun> runs;
    for (const FittedRun& run : fitted_) {
      runs.push_back(placed ? simulation::SimulateArm(ArmOf(run.kept), run.recorded, run.baseline.x,
                                                      run.baseline.excess)
                            : run.simulated);
    }
    estimation::Problem problem = simulation::ArmProblem(runs);
    for (std::size_t b = 0; placed && b < problem.blocks().size(); ++b) {
      auto& block = problem.Block({static_cast<int>(b)});
      if (block.name.starts_with("base") || block.name.starts_with("ball ")) continue;
      block.Hold();
      for (auto& entry : block.entries) entry.value = entry.nominal;
    }
    return simulation::SolveLinkage(problem, 0, false, kArmSettled);
  }

  // Runs that do not go together leave more than each alone, and what they share is no noise of
  // each. False where nothing changes.
  bool RaiseNoise() {
    constexpr double kMuchMore = 4.0 / 3.0;
    std::vector<VectorXd> left;
    for (const FittedRun& run : fitted_) {
      left.emplace_back(run.simulated.residual->Rows());
      run.simulated.residual->Evaluate(ValuesFound(fit_, run.simulated.blocks), left.back(),
                                       nullptr);
    }
    bool raised = false;
    for (std::size_t r = 0; r < fitted_.size(); ++r) {
      FittedRun& run = fitted_[r];
      double sharers = 1.0;
      for (std::size_t other = 0; other < fitted_.size(); ++other) {
        if (other == r || fitted_[other].kept.mounting != run.kept.mounting) continue;
        sharers += simulation::SharedLeft(run.kept.readings.angles, left[r],
                                          fitted_[other].kept.readings.angles, left[other]);
      }
      double& used = run.baseline.excess;
      const double alone = simulation::ExcessOf(fit_.sources[r], left[r], run.kept.time, used);
      const double excess = alone > 1.0 ? alone * std::sqrt(sharers) : 1.0;
      if (excess < kMuchMore * used) continue;
      used = excess;
      run.simulated = simulation::SimulateArm(ArmOf(run.kept), run.kept, run.baseline.x, excess);
      raised = true;
    }
    return raised;
  }

  // The part of what is left that no larger noise contains.
  void AddDiscrepancy() {
    std::vector<ArmLeft> runs;
    double least = 1.0;
    for (const FittedRun& run : fitted_) {
      runs.push_back(LeftOf(run));
      least = std::min(least, 1.0 / (run.baseline.excess * run.baseline.excess));
    }
    VectorXd prior_sd(std::ssize(fit_.names)), off(prior_sd.size());
    for (const auto& block : fit_.blocks) {
      for (std::size_t i = 0; i < block.entries.size(); ++i) {
        const auto at = std::find(fit_.names.begin(), fit_.names.end(), block.FullName(i));
        if (at == fit_.names.end()) continue;
        prior_sd[at - fit_.names.begin()] = block.entries[i].prior_sd;
        off[at - fit_.names.begin()] = block.entries[i].value - block.entries[i].nominal;
      }
    }
    const Discrepancy found = DiscrepancyOf(runs, prior_sd, off, fit_.covariance, least);
    fit_.covariance += found.covariance;
    no_noise_ = found.probability;
  }

  ArmLeft LeftOf(const FittedRun& run) const {
    const VectorXd x = ValuesFound(fit_, run.simulated.blocks);
    const Index rows = run.simulated.residual->Rows(), pivots = run.kept.readings.angles.rows();
    ArmLeft found{run.kept.readings.angles,
                  run.kept.time,
                  VectorXd(rows),
                  Eigen::MatrixXd::Zero(rows, fit_.covariance.cols()),
                  {}};
    estimation::RowMatrix J(rows, x.size());
    run.simulated.residual->Evaluate(x, found.left, &J);
    const auto columns = simulation::ColumnsOf(run.simulated.blocks, run.kept.mounting, fit_.names);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (columns[i] >= 0) found.by_parameters.col(columns[i]) = J.col(i);
    }
    std::vector<simulation::Disturbance> moved;
    for (Index stage = 0; stage < pivots + 3; ++stage) {
      moved.emplace_back(run.kept.poses());
      moved.back()
          .row(stage < pivots ? simulation::kEncoderStage + stage
                              : simulation::kTipStage + stage - pivots)
          .setOnes();
    }
    found.by_stage = run.simulated.response->At(x)->Columns(moved);
    return found;
  }

  void RefusePoor() const {
    Index poses = 0;
    for (const FittedRun& run : fitted_) poses += run.kept.poses();
    const Index free = fit_.names.size();
    if (3 * poses >= free) return;
    throw InputError(fmt::format(
        "{}: {} poses give {} numbers for {} parameters; record at least {} poses, well spread",
        fitted_.front().kept.name, poses, 3 * poses, free, free));
  }

  const FittedRun& Like(const LinkageRun& run) const {
    std::set<std::string> bases, balls;
    const FittedRun* like = nullptr;
    bool knows_ball = false;
    for (const FittedRun& other : fitted_) {
      bases.insert(other.kept.mounting);
      balls.insert(other.kept.ball);
      if (other.kept.mounting == run.mounting) like = &other;
      knows_ball = knows_ball || other.kept.ball == run.ball;
    }
    if (like != nullptr && knows_ball) return *like;
    throw InputError(fmt::format(
        "{}: no recording of the calibration has its {} \"{}\", only \"{}\"; calibrate with one that "
        "has, or hold some of its poses out",
        run.name, like == nullptr ? "mounting.base" : "mounting.ball",
        like == nullptr ? run.mounting : run.ball,
        fmt::join(like == nullptr ? bases : balls, "\", \"")));
  }

  // The parameters of LinkageSimulation for a run.
  VectorXd ParametersOf(const Result& fit, const LinkageRun& run) const {
    const FittedRun& like = Like(run);
    auto blocks = like.simulated.blocks;
    for (auto& block : blocks) {
      if (block.name == simulation::BallBlock(like.kept.ball)) {
        block.name = simulation::BallBlock(run.ball);
      }
    }
    return ValuesFound(fit, blocks);
  }

  LinkageSimulation ArmOf(const LinkageRun& run) const {
    return simulation::ArmSimulation(Like(run).baseline.settings);
  }

  static VectorXd ModelPart(const VectorXd& x) {
    return x.tail(x.size() - LinkageSimulation::kBase);
  }

  WrittenChain WrittenBy(const Result& fit, const std::string& ball) const {
    LinkageRun run = fitted_.front().kept;
    run.ball = ball;
    return nominal_.With(ArmOf(run).model().ChainAt(ModelPart(ParametersOf(fit, run))));
  }

  // Standard uncertainties of what is written, by its change with each free parameter.
  VectorXd Uncertainties(ArmCalibration& found) const {
    constexpr double kStep = 1e-6;  // m, rad: curvature and rounding both stay below 1e-5
    constexpr double kRounding = 1e-13;
    const LinkageRun& run = fitted_.front().kept;
    const LinkageSimulation arm = ArmOf(run);
    const VectorXd x = ParametersOf(fit_, run), numbers = found.written.Numbers();
    const auto columns =
        simulation::ColumnsOf(fitted_.front().simulated.blocks, run.mounting, fit_.names);
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(numbers.size(), fit_.covariance.cols());
    for (Index i = LinkageSimulation::kBase; i < x.size(); ++i) {
      const int column = columns[i];
      if (column < 0) continue;
      const auto at = [&](double step) {
        VectorXd moved = x;
        moved[i] += step;
        return nominal_.With(arm.model().ChainAt(ModelPart(moved))).Numbers();
      };
      const VectorXd change = at(kStep) - at(-kStep);
      // A number that the parameter does not move is held: what is left there is rounding.
      const auto moved = change.array().abs() > kRounding * (1.0 + numbers.array().abs());
      J.col(column) = moved.select(change, 0.0) / (2.0 * kStep);
    }
    found.ball_noise = BallNoise();
    return 2.0 * (J * fit_.covariance).cwiseProduct(J).rowwise().sum().cwiseMax(0.0).cwiseSqrt();
  }

  // What the covariance makes of the ball, m rms over the coordinates of all poses.
  double BallNoise() const {
    double squares = 0.0, count = 0.0;
    for (const FittedRun& run : fitted_) {
      Matrix3Xd gap;
      estimation::RowMatrix J_x;
      ArmOf(run.kept).Gap(run.kept, ParametersOf(fit_, run.kept), gap, &J_x);
      std::vector<int> columns =
          simulation::ColumnsOf(run.simulated.blocks, run.kept.mounting, fit_.names);
      Eigen::MatrixXd J = Eigen::MatrixXd::Zero(J_x.rows(), fit_.covariance.cols());
      for (std::size_t i = 0; i < columns.size(); ++i) {
        if (columns[i] >= 0) J.col(columns[i]) = J_x.col(i);
      }
      squares += (J * fit_.covariance).cwiseProduct(J).sum();
      count += J.rows();
    }
    return std::sqrt(squares / count);
  }

  ArmFigures FiguresOf(const ArmPoses& run) const {
    const FittedRun& like = Like(run.corrected);
    const LinkageSimulation arm = ArmOf(run.corrected);
    // Poses that are no reading of this arm, as its own runs have them.
    Matrix3Xd before, after;
    arm.Gap(run.recorded, ParametersOf(before_, run.corrected), before);
    const WrittenChain written = WrittenBy(fit_, run.corrected.ball);
    const VectorXd x = ParametersOf(fit_, run.corrected);
    const auto X_MW =
        simulation::BaseAt(arm.settings().X_MB, x.head<LinkageSimulation::kBase>()) * written.X_BW;
    const relm::SerialChain chain = written.Chain();
    after.resize(3, run.corrected.poses());
    for (Index pose = 0; pose < after.cols(); ++pose) {
      const VectorXd q = run.corrected.readings.angles.col(pose);
      after.col(pose) = X_MW * chain.Tip(q) - run.corrected.reference.col(pose);
    }
    ArmBaseline baseline = like.baseline;
    if (like.kept.ball != run.corrected.ball) {
      for (const FittedRun& other : fitted_) {
        if (other.kept.ball == run.corrected.ball) baseline = other.baseline;
      }
    }
    const std::vector<Index> far = FarOff(run.corrected, baseline);
    std::vector<Index> kept;
    for (Index pose = 0; pose < after.cols(); ++pose) {
      if (!std::binary_search(far.begin(), far.end(), pose)) kept.push_back(pose);
    }
    return {run.recorded.name, run.recorded.poses(), std::ssize(far),
            DistancesOf(before(Eigen::all, kept)), DistancesOf(after(Eigen::all, kept))};
  }

  const relm::LinkageSettings& settings_;
  WrittenChain nominal_;
  std::vector<FittedRun> fitted_;
  Result fit_, before_;
  double no_noise_ = 0.0;
};

}  // namespace

ArmCalibration CalibrateArm(const relm::LinkageSettings& settings,
                            const std::vector<ArmPoses>& runs, const std::vector<ArmPoses>& tests) {
  return ArmJob(settings, runs).Found(runs, tests);
}

void AddDoubt(const ArmCalibration& without, double unexplained, ArmCalibration& found) {
  const VectorXd change = found.written.Numbers() - without.written.Numbers();
  double left = 0.0;  // of a coordinate: what is unexplained moves the ball by no more
  for (const ArmFigures& run : found.runs) left = std::max(left, run.after.rms / std::sqrt(3.0));
  const double wider = std::hypot(1.0, std::min(unexplained, left) / found.ball_noise);
  found.u95 = ((wider * found.u95).array().square() + (2.0 * change).array().square()).sqrt();
}

}  // namespace abbe::fusion
