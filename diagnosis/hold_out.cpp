#include "diagnosis/hold_out.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "diagnosis/extended_run.h"
#include "diagnosis/fit.h"
#include "failure/failure.h"
#include "fusion/machine_problem.h"
#include "simulation/arm/arm_run.h"
#include "simulation/linkage/linkage_gaps.h"

namespace abbe::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using recording::Recording;

constexpr std::size_t kHeldOutBlocks = 8;

Recording RowsWhere(const Recording& recording, const std::function<bool(std::size_t)>& wanted) {
  Recording part = recording;
  for (auto& column : part.columns) column.values.clear();
  for (std::size_t row = 0; row < recording.rows(); ++row) {
    if (!wanted(row)) continue;
    for (std::size_t c = 0; c < part.columns.size(); ++c) {
      part.columns[c].values.push_back(recording.columns[c].values[row]);
    }
  }
  return part;
}

// Runs of the linkage on one base that are held out whole: every second one, when there are enough.
// A part of a run would not know which way its axes last turned.
std::set<const Recording*> HeldRuns(const std::vector<Recording>& recordings) {
  constexpr std::size_t kEnough = 3;
  std::map<std::string, std::vector<const Recording*>> by_base;
  for (const Recording& recording : recordings) {
    if (recording.Kind() != "linkage" || simulation::IsArm(recording)) continue;
    by_base[recording.HeaderText("mounting.base").value_or("")].push_back(&recording);
  }
  std::set<const Recording*> held;
  for (const auto& [base, runs] : by_base) {
    if (runs.size() < kEnough) continue;
    for (std::size_t i = 1; i < runs.size(); i += 2) held.insert(runs[i]);
  }
  return held;
}

// Which rows are held out; empty: none.
std::function<bool(std::size_t)> HeldRows(const Recording& recording) {
  const std::string kind = recording.Kind();
  if (kind != "sweep" && kind != "linkage" && kind != "reference" && kind != "shaft") return {};
  if (simulation::IsArm(recording)) {
    constexpr std::size_t kFourth = 4;
    return [](std::size_t row) { return row % kFourth == 0; };
  }
  const auto pass = recording.Find("pass");
  const std::set<double> passes =
      pass ? std::set<double>(pass->begin(), pass->end()) : std::set<double>{};
  if (passes.size() > 1) {
    return [pass](std::size_t row) { return std::lround((*pass)[row]) % 2 == 0; };
  }
  if (kind == "sweep") return {};
  const std::size_t block = recording.rows() / kHeldOutBlocks + 1;
  return [block](std::size_t row) { return (row / block) % 2 == 1; };
}

// Of a shaft the sensors are silent in other rows: its angle is needed throughout.
Recording SpokenWhere(const Recording& recording, const std::function<bool(std::size_t)>& wanted) {
  Recording part = recording;
  for (auto& column : part.columns) {
    if (!column.name.starts_with("gap_")) continue;
    for (std::size_t row = 0; row < part.rows(); ++row) {
      if (!wanted(row)) column.values[row] = std::numeric_limits<double>::quiet_NaN();
    }
  }
  return part;
}

// The simulation of a run at the solution of another fit.
VectorXd ResidualAt(const Fit& fit, const DiagnosedRun& run) {
  const VectorXd x = fusion::ValuesFound(fit.result(), run.simulated.blocks);
  const LinearRun at = LinearAt(run, x, {}, fit.taken_in());
  const auto extended = Extend(run, at, fit.taken_in());
  VectorXd residual(extended.residual->Rows());
  extended.residual->Evaluate(fusion::ValuesFound(fit.result(), extended.blocks), residual,
                              nullptr);
  return residual;
}

// Of what is left of the held rows, in units of the stated noise; of arms in space too.
struct Left {
  Index rows = 0, poses = 0;
  double rms = 0.0, in_space = 0.0;
};

Left LeftOf(const Campaign& held, const Fit& fit) {
  double sum = 0.0, in_space = 0.0;
  Left left;
  for (const DiagnosedRun& run : held.runs()) {
    const VectorXd residual = ResidualAt(fit, run);
    sum += residual.squaredNorm() * run.excess * run.excess;
    left.rows += residual.size();
    const auto* gaps = dynamic_cast<const simulation::LinkageGaps*>(run.simulated.residual.get());
    if (gaps == nullptr) continue;
    in_space += gaps->InSpace(residual).squaredNorm();
    left.poses += residual.size() / 3;
  }
  left.rms = std::sqrt(sum / static_cast<double>(left.rows));
  if (left.poses > 0) left.in_space = std::sqrt(in_space / static_cast<double>(left.poses));
  return left;
}

double SeenBy(const Fit& fit) {
  return std::sqrt(fit.chi_square() / static_cast<double>(fit.rows()));
}

HeldOutGain::Without Without(std::size_t cause, std::vector<Candidate> causes, const Fit& baseline,
                             const Campaign& held) {
  causes.erase(causes.begin() + static_cast<std::ptrdiff_t>(cause));
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
  Campaign kept(campaign.setup(), campaign.origin()), held(campaign.setup(), campaign.origin());
  const std::set<const Recording*> whole = HeldRuns(recordings);
  for (const Recording& recording : recordings) {
    if (!whole.empty() && recording.Kind() == "linkage" && !simulation::IsArm(recording)) {
      (whole.contains(&recording) ? held : kept).Add(recording);
      continue;
    }
    const auto is_held = HeldRows(recording);
    if (!is_held) {
      kept.Add(recording);
      continue;
    }
    const auto part = recording.Kind() == "shaft" ? SpokenWhere : RowsWhere;
    kept.Add(part(recording, [&](std::size_t row) { return !is_held(row); }));
    held.Add(part(recording, is_held));
  }
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

}  // namespace abbe::diagnosis
