#include "probes/sweep_stations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>

#include "estimation/reading_step.h"
#include "failure/failure.h"
#include "probes/dwell_fit.h"
#include "probes/one_pass_drift.h"
#include "settings/unit.h"
#include "standards/chi_squared.h"

namespace abbe::probes {
namespace {

constexpr double kSignificance = 0.99;
constexpr double kFewDwells = 10.0;  // fewest degrees of freedom within the dwells for a scatter
constexpr double kLeastVariance = 1e-24;  // m^2: a noise-free recording is known to 1 pm

Eigen::Index Row(std::size_t probe) { return probe; }

// Keeps the stations that were approached from every direction of the sweep, and their dwells.
void KeepCompleteStations(const std::string& name, const SweepDwells& sweep, StationMeans& means) {
  std::set<int, std::greater<>> directions;
  std::vector<std::set<int>> seen(sweep.stations.size());
  for (const Dwell& dwell : sweep.dwells) {
    directions.insert(dwell.direction);
    seen[dwell.station].insert(dwell.direction);
  }
  means.directions.assign(directions.begin(), directions.end());
  constexpr std::size_t kDropped = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> kept(sweep.stations.size(), kDropped);
  for (std::size_t station = 0; station < sweep.stations.size(); ++station) {
    if (seen[station].size() != directions.size()) continue;
    kept[station] = means.stations.size();
    means.stations.push_back(sweep.stations[station]);
  }
  const std::string frozen = sweep.FrozenText();
  if (means.stations.size() < 3) {
    throw InputError(fmt::format(
        "{}: {} of {} stations were approached from every direction of the sweep, at least 3 are "
        "needed; record a complete pass or correct sweep.window_um in the header{}{}",
        name, means.stations.size(), sweep.stations.size(),
        frozen.empty() ? "" : "; dwells were left out where a channel is frozen: ", frozen));
  }
  if (!frozen.empty()) {
    means.notes.push_back(
        fmt::format("{}, as no probe does: the channel was frozen there and these dwells are left "
                    "out; look at its amplifier and at how its register is renewed",
                    frozen));
  }
  if (means.stations.size() < sweep.stations.size()) {
    means.notes.push_back(
        fmt::format("{} of {} stations are left out: they were not approached from every direction "
                    "of the sweep",
                    sweep.stations.size() - means.stations.size(), sweep.stations.size()));
  }
  for (Dwell dwell : sweep.dwells) {
    if (kept[dwell.station] == kDropped) continue;
    dwell.station = kept[dwell.station];
    means.dwells.push_back(dwell);
  }
}

// The variance of a dwell's mean from the scatter within the dwells. Averaging over the length T of
// a dwell reduces the drift's variance S^2 by S^2 T / (3 tau), to first order in T / tau.
Eigen::MatrixXd WhiteFromWithin(const StationMeans& means, const PerProbe<Scatter>& scatter,
                                const ProbeNoise& noise) {
  constexpr double kLeastShare = 0.1;  // of the white variance is kept where the drift dominates
  Eigen::MatrixXd white(means.dwells.size(), kProbes);
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    const double r = std::clamp(scatter[probe].lag1, 0.0, 0.99);
    const double one = scatter[probe].white * scatter[probe].white * (1.0 + r) / (1.0 - r);
    for (std::size_t i = 0; i < means.dwells.size(); ++i) {
      const Dwell& dwell = means.dwells[i];
      const double variance = one / dwell.samples;
      const double averaged = noise.drift * noise.drift * dwell.duration / (3.0 * noise.drift_time);
      white(i, Row(probe)) =
          std::max({variance - averaged, kLeastShare * variance, kLeastVariance});
    }
  }
  return white;
}

Eigen::MatrixXd Constant(const StationMeans& means, double variance) {
  return Eigen::MatrixXd::Constant(means.dwells.size(), kProbes,
                                   std::max(variance, kLeastVariance));
}

// The variance of a dwell for which the scatter between the passes has chi2 = dof.
double WhiteFromPasses(const DwellFit& fit, const ProbeNoise& noise, StationMeans& means) {
  double low = 1e-12, high = 1e-3;  // m
  for (int step = 0; step < 50; ++step) {
    const double middle = std::sqrt(low * high);
    (fit.Run(Constant(means, middle * middle), noise, means).chi2 > fit.dof() ? low : high) =
        middle;
  }
  return low * high;
}

Eigen::MatrixXd ChooseWhite(const SweepDwells& sweep, const ProbeNoise& noise, const DwellFit& fit,
                            StationMeans& means) {
  double within_dof = std::numeric_limits<double>::infinity();
  double dof = 0.0;
  for (const Scatter& scatter : sweep.scatter) {
    within_dof = std::min(within_dof, scatter.dof);
    dof += scatter.dof;
  }
  if (within_dof >= kFewDwells) {
    means.noise.u_dof = dof;
    return WhiteFromWithin(means, sweep.scatter, noise);
  }
  if (fit.dof() > 0.0) {
    means.noise.u_dof = fit.dof();
    means.notes.push_back(
        fmt::format("the dwells hold too few readings to show their noise: it is taken from the "
                    "scatter between "
                    "the passes, with {} degrees of freedom",
                    fit.dof()));
    return Constant(means, WhiteFromPasses(fit, noise, means));
  }
  means.notes.push_back(
      "one reading per dwell and one pass show no noise: it is taken from noise.probe_nm of the "
      "machine file");
  means.noise.u_dof = std::numeric_limits<double>::infinity();
  return Constant(means, noise.probe * noise.probe);
}

bool Scattered(double chi2, double dof) {
  return chi2 > standards::ChiSquaredQuantile(kSignificance, dof);
}

// The noise that makes the dwells of all probes most probable.
NoiseFactors NoiseOfPasses(const DwellFit& fit, const ProbeNoise& noise,
                           const StationMeans& means) {
  StationMeans scratch = means;
  return MostProbableNoise([&](const NoiseFactors& logs) {
           return fit.Run(std::exp(2.0 * logs[0]) * means.white, Times(noise, logs), scratch)
               .log_likelihood;
         })
      .logs;
}

// Tests the noise model against the scatter between the passes. Where that is significantly larger,
// takes the noise from it if asked to; what that does not explain scales the covariances up.
void CheckAgainstPasses(DwellFit& fit, const ProbeNoise& noise, ExcessNoise excess,
                        StationMeans& means) {
  double chi2 = fit.Run(means.white, noise, means).chi2;
  double dof = fit.dof();
  NoiseFactors found{};
  if (excess == ExcessNoise::kFitted && dof > 0.0 && Scattered(chi2, dof) &&
      fit.FindWild(means.white, noise)) {
    chi2 = fit.Run(means.white, noise, means).chi2;
  }
  if (excess == ExcessNoise::kFitted && dof > 0.0 && Scattered(chi2, dof)) {
    found = NoiseOfPasses(fit, noise, means);
    if (fit.FindMoves(means.white, noise, found)) {
      chi2 = fit.Run(means.white, noise, means).chi2;
      dof = fit.dof();
      if (Scattered(chi2, dof)) found = NoiseOfPasses(fit, noise, means);
    }
  }
  means.noise.chi2 = chi2;
  means.noise.dof = dof;
  if (dof <= 0.0) {
    means.notes.push_back(
        "one pass: nothing checks the noise model; measure at least two passes to see the scatter");
    return;
  }
  if (!Scattered(chi2, dof)) return;
  means.noise.scale = std::sqrt(chi2 / dof);
  means.noise.u_dof = dof;
  if (excess == ExcessNoise::kScaled) {
    for (Eigen::MatrixXd& covariance : means.covariance) covariance *= chi2 / dof;
    means.notes.push_back(
        fmt::format("the passes scatter {:.2f} times more than the noise model predicts: the noise "
                    "part of u is scaled up by it; look for drift, vibration or a loose mounting, "
                    "or correct [noise]",
                    means.noise.scale));
    return;
  }
  means.white *= std::exp(2.0 * found[0]);
  const double left = fit.Run(means.white, Times(noise, found), means).chi2;
  if (Scattered(left, dof)) {
    for (Eigen::MatrixXd& covariance : means.covariance) covariance *= left / dof;
  }
  means.notes.push_back(fmt::format(
      "the passes scatter {:.2f} times more than the noise model predicts: the noise part of u is "
      "scaled up to what they show, white noise {:.1f} times, drift {:.1f} times and its time "
      "{:.1f} times what the dwells and [noise] say; look for drift, vibration or a loose "
      "mounting, or correct [noise]",
      means.noise.scale, std::exp(found[0]), std::exp(found[1]), std::exp(found[2])));
}

void FillResidualsAndFigures(const SweepDwells& sweep, const DwellFit& fit, StationMeans& means) {
  const Eigen::Index dwells = means.dwells.size();
  means.position = Eigen::VectorXd::Zero(fit.group_count());
  means.residual.resize(kProbes, dwells);
  Eigen::VectorXd counts = Eigen::VectorXd::Zero(fit.group_count());
  for (Eigen::Index i = 0; i < dwells; ++i) {
    const Dwell& dwell = means.dwells[i];
    const int group = fit.groups()[i];
    means.position[group] += dwell.position;
    counts[group] += 1.0;
    for (std::size_t probe = 0; probe < kProbes; ++probe) {
      means.residual(Row(probe), i) = dwell.gap[probe] - means.gap(Row(probe), group);
    }
  }
  means.position.array() /= counts.array();
  const double dof = dwells - fit.group_count();
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    ProbeFigures& figures = means.noise.probes[probe];
    figures = {sweep.scatter[probe].white, sweep.scatter[probe].lag1, 0.0};
    if (dof <= 0.0) continue;
    const double between = means.residual.row(Row(probe)).squaredNorm() / dof;
    figures.drift = std::sqrt(std::max(0.0, between - means.white.col(Row(probe)).mean()));
  }
}

// What readings in steps hide from every repetition.
void AddUnseenSteps(const SweepDwells& sweep, StationMeans& means) {
  constexpr double kMatters = 0.1;  // of the variance of a mean
  const auto directions = static_cast<Eigen::Index>(means.directions.size());
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    const ProbeFigures& figures = means.noise.probes[probe];
    const double moved = figures.white * figures.white + figures.drift * figures.drift;
    const double unseen = estimation::ReadingStep::Unseen(sweep.step[probe], moved);
    Eigen::MatrixXd& covariance = means.covariance[probe];
    if (unseen > kMatters * covariance.diagonal().mean()) {
      means.notes.push_back(fmt::format(
          "probe {} reads in steps of {:.3g} um, which hide more than its noise: u contains them; "
          "a finer range or converter shows more",
          "abcde"[probe], sweep.step[probe] / settings::kMicrometre));
    }
    for (Eigen::Index station = 0; station < means.groups(); station += directions) {
      covariance.block(station, station, directions, directions).array() += 0.5 * unseen;
    }
    covariance.diagonal().array() += 0.5 * unseen;
  }
}

}  // namespace

namespace {

// Whatever drifts slowly one way looks like it.
std::string DriftNote(const ZeroMove& drift) {
  const double u95 = 1.96 * drift.u;
  const std::string size =
      std::abs(drift.size) > u95
          ? fmt::format("by {:.3g} +- {:.2g} um (95 %) with a time constant of {:.3g} s",
                        drift.size / settings::kMicrometre, u95 / settings::kMicrometre,
                        drift.settles)
          : "over the whole sweep";
  return fmt::format(
      "the zero of probe_{:c} drifts like one that warms up, {}: this is taken out, as two more "
      "unknowns; let head and amplifier warm up before a sweep, or look for what else drifts",
      'a' + drift.probe, size);
}

}  // namespace

std::vector<std::string> MoveNotes(char axis, const StationMeans& means) {
  const auto place = [axis](const Dwell& dwell) {
    return fmt::format("{:c} = {:.6g} mm, pass {} {}", axis, dwell.position / settings::kMillimetre,
                       dwell.pass, dwell.direction > 0 ? "forward" : "backward");
  };
  std::vector<std::string> notes;
  for (const ZeroMove& move : means.moves) {
    if (move.settles > 0.0) {
      notes.push_back(DriftNote(move));
      continue;
    }
    const Dwell &before = means.dwells[move.dwell - 1], &after = means.dwells[move.dwell];
    notes.push_back(fmt::format(
        "the zero of probe_{:c} jumps by {:.3g} +- {:.2g} um (95 %) about {:.1f} s, between {} and "
        "{}: it is taken out, as one more unknown; look at the clamping, the cable and the "
        "amplifier of this probe",
        'a' + move.probe, move.size / settings::kMicrometre, 1.96 * move.u / settings::kMicrometre,
        0.5 * (before.time + after.time), place(before), place(after)));
  }
  for (const WildDwell& wild : means.wild) {
    const Dwell& dwell = means.dwells[wild.dwell];
    notes.push_back(fmt::format(
        "probe_{:c} reads {:+.3g} um off at {}, against {}; look for dirt, a shock or a loose cable "
        "then",
        'a' + wild.probe, wild.off / settings::kMicrometre, place(dwell),
        wild.or_other ? "the only other pass: either of them may be wrong, and u of this station "
                        "contains what they differ by"
                      : "all other passes: it hardly counts there"));
  }
  return notes;
}

StationMeans FitStations(const std::string& name, const SweepDwells& sweep, const ProbeNoise& noise,
                         ExcessNoise excess) {
  StationMeans means;
  KeepCompleteStations(name, sweep, means);
  DwellFit fit(means);
  means.white = ChooseWhite(sweep, noise, fit, means);
  CheckAgainstPasses(fit, noise, excess, means);
  fit.TakeMovesOut(means);
  std::ranges::move(MoveNotes(sweep.axis, means), std::back_inserter(means.notes));
  FillResidualsAndFigures(sweep, fit, means);
  AddUnseenSteps(sweep, means);
  if (excess == ExcessNoise::kFitted && means.noise.dof <= 0.0) {
    CountUncheckedNoise(sweep.axis, means);
  }
  return means;
}

}  // namespace abbe::probes
