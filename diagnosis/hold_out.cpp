#include "diagnosis/hold_out.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "diagnosis/extended_run.h"
#include "diagnosis/fit.h"
#include "estimation/in_parallel.h"
#include "failure/failure.h"
#include "fusion/machine_problem.h"
#include "simulation/kinds.h"

namespace abbe::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using recording::Recording;

// Runs that are held out (true) or kept (false) as a whole; the others are held out by rows.
std::map<const Recording*, bool> WholeRuns(const std::vector<Recording>& recordings) {
  constexpr std::size_t kEnough = 3;
  using Group = std::pair<const simulation::RunKind*, std::string>;
  std::map<Group, std::vector<const Recording*>> groups;
  for (const Recording& recording : recordings) {
    const simulation::RunKind& kind = simulation::KindOf(recording);
    if (const auto group = kind.HeldOutGroup(recording)) {
      groups[{&kind, *group}].push_back(&recording);
    }
  }
  std::set<const simulation::RunKind*> held_whole;
  for (const auto& [group, runs] : groups) {
    if (runs.size() >= kEnough) held_whole.insert(group.first);
  }
  std::map<const Recording*, bool> whole;
  for (const auto& [group, runs] : groups) {
    if (!held_whole.contains(group.first)) continue;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      whole.emplace(runs[i], runs.size() >= kEnough && i % 2 == 1);
    }
  }
  return whole;
}

// Whether a fit has all parameters of a run. It lacks those of the readings within stays where only
// the held-out half of a sweep scatters in them.
bool Knows(const Fit& fit, const PreparedRun& run) {
  return std::ranges::all_of(run.simulated.blocks, [&](const auto& block) {
    return std::ranges::find(fit.result().blocks, block.name, &estimation::ParameterBlock::name) !=
           fit.result().blocks.end();
  });
}

// The simulation of a run at the solution of another fit.
VectorXd ResidualAt(const Fit& fit, const PreparedRun& run) {
  const VectorXd x = fusion::ValuesFound(fit.result(), run.simulated.blocks);
  const LinearRun at = LinearAt(run, x, {}, fit.taken_in());
  const auto extended = Extend(run, at, fit.taken_in());
  VectorXd residual(extended.residual->Rows());
  extended.residual->Evaluate(fusion::ValuesFound(fit.result(), extended.blocks), residual,
                              nullptr);
  return residual;
}

// The residual of the held-out rows, in units of the stated noise; of arms also in space.
struct Left {
  Index rows = 0, poses = 0;
  double rms = 0.0, in_space = 0.0;
};

Left LeftOf(const Campaign& held, const Fit& fit) {
  const std::vector<PreparedRun>& runs = held.runs();
  std::vector<VectorXd> residuals(runs.size());
  estimation::InParallel(runs.size(), [&](std::size_t r) {
    if (Knows(fit, runs[r])) residuals[r] = ResidualAt(fit, runs[r]);
  });
  double sum = 0.0, in_space = 0.0;
  Left left;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const PreparedRun& run = runs[r];
    const VectorXd& residual = residuals[r];
    if (residual.size() == 0) continue;
    sum += residual.squaredNorm() * run.excess * run.excess;
    left.rows += residual.size();
    if (!run.simulated.in_space) continue;
    in_space += run.simulated.in_space(residual).squaredNorm();
    left.poses += residual.size() / 3;
  }
  left.rms = std::sqrt(sum / left.rows);
  if (left.poses > 0) left.in_space = std::sqrt(in_space / left.poses);
  return left;
}

double SeenBy(const Fit& fit) { return std::sqrt(fit.chi_square() / fit.rows()); }

HeldOutGain::Without Without(std::size_t cause, std::vector<Candidate> causes, const Fit& baseline,
                             const Campaign& held) {
  causes.erase(causes.begin() + cause);
  try {
    const Fit fit(baseline, causes);
    return {SeenBy(fit), LeftOf(held, fit).rms};
  } catch (const NumericalError&) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    return {kNone, kNone};
  }
}

}  // namespace

HeldOutGain HoldOut(const Campaign& campaign, const std::vector<Recording>& recordings,
                    const std::vector<Candidate>& causes) {
  Campaign kept = campaign.WithoutRuns(), held = campaign.WithoutRuns();
  const std::map<const Recording*, bool> whole = WholeRuns(recordings);
  std::vector<Recording> to_keep, to_hold;
  for (const Recording& recording : recordings) {
    if (const auto found = whole.find(&recording); found != whole.end()) {
      (found->second ? to_hold : to_keep).push_back(recording);
      continue;
    }
    const simulation::RunKind& kind = simulation::KindOf(recording);
    const simulation::RowRule is_held = kind.HeldOut(recording);
    if (!is_held) {
      to_keep.push_back(recording);
      continue;
    }
    to_keep.push_back(kind.Part(recording, [&](std::size_t row) { return !is_held(row); }));
    to_hold.push_back(kind.Part(recording, is_held));
  }
  kept.Add(std::move(to_keep));
  held.Add(std::move(to_hold));
  if (held.runs().empty()) return {};
  const Fit baseline(kept);
  const Left before = LeftOf(held, baseline);
  HeldOutGain gain{before.rows,  before.rms,      before.rms,
                   before.poses, before.in_space, before.in_space};
  if (causes.empty()) return gain;
  const Fit all(baseline, causes);
  const Left after = LeftOf(held, all);
  gain.after = after.rms;
  gain.arm_after = after.in_space;
  gain.seen = SeenBy(all);
  for (std::size_t i = 0; i < causes.size(); ++i) {
    gain.without.push_back(causes.size() == 1 ? HeldOutGain::Without{SeenBy(baseline), before.rms}
                                              : Without(i, causes, baseline, held));
  }
  return gain;
}

HeldOutGain HoldOutWhereTheySuffice(const Campaign& campaign,
                                    const std::vector<recording::Recording>& recordings,
                                    const std::vector<Candidate>& causes, std::string& why_not) {
  // How well an arm is known where it was not fitted is worth a figure also without a cause.
  if (causes.empty() && !campaign.EstimatesNoise()) return {};
  try {
    return HoldOut(campaign, recordings, causes);
  } catch (const NumericalError& error) {
    why_not = fmt::format(
        "the gain on held-out data is unknown, because half of the runs do not suffice for a fit: "
        "{}",
        error.what());
    return {};
  }
}

}  // namespace abbe::diagnosis
