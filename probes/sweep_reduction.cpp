#include "probes/sweep_reduction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "failure/failure.h"
#include "probes/channel_order.h"
#include "probes/sweep_notes.h"
#include "probes/sweep_slips.h"
#include "probes/sweep_stations.h"
#include "recording/made_on.h"
#include "standards/straightness.h"
#include "standards/student_coverage.h"

namespace abbe::probes {
namespace {

using Sources = std::array<Eigen::MatrixXd, kSources>;

Eigen::MatrixXd Sum(const Sources& sources) {
  return std::accumulate(sources.begin() + 1, sources.end(), sources.front());
}

Eigen::VectorXd Deviations(const Eigen::MatrixXd& covariance) {
  return covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
}

double RootMeanSquare(const Eigen::MatrixXd& covariance) {
  return std::sqrt(std::max(0.0, covariance.diagonal().mean()));
}

std::vector<double> ToList(const Eigen::VectorXd& values) {
  return {values.data(), values.data() + values.size()};
}

// Whether passes show the noise.
bool Checked(const StationMeans& means) { return means.noise.dof > 0.0; }

// How much more the means of the halves of the passes scatter than the noise of single dwells makes
// them, as a factor on the standard deviation of the mean reversal, and its degrees of freedom. A
// drift, or a carriage that settles another way each time, shifts all stations of a half alike: it
// does not average out, and looks like a reversal.
struct HalfScatter {
  double times = 1.0;
  double freedom = 0.0;  // 0: too few passes to tell
};

HalfScatter ScatterOfHalves(const StationMeans& means) {
  using Half = std::pair<int, int>;  // direction, pass
  std::map<Half, std::pair<Eigen::Matrix<double, kProbes, 1>, int>> halves;
  for (std::size_t i = 0; i < means.dwells.size(); ++i) {
    const Dwell& dwell = means.dwells[i];
    auto& [sum, count] = halves
                             .try_emplace({dwell.direction, dwell.pass},
                                          Eigen::Matrix<double, kProbes, 1>::Zero(), 0)
                             .first->second;
    sum += means.residual.col(static_cast<Eigen::Index>(i));
    ++count;
  }
  std::map<int, int> passes;
  for (const auto& [half, sums] : halves) ++passes[half.first];
  HalfScatter scatter;
  Eigen::Matrix<double, kProbes, 1> variance = Eigen::Matrix<double, kProbes, 1>::Zero();
  for (const auto& [direction, count] : passes) {
    if (count < 2) return {};
    scatter.freedom += 0.5 * kProbes * (count - 1);  // the probes see one machine
    for (const auto& [half, sums] : halves) {
      if (half.first != direction) continue;
      variance += (sums.first / sums.second).cwiseAbs2() / ((count - 1.0) * count);
    }
  }
  const Eigen::Index stations = std::ssize(means.stations),
                     directions = std::ssize(means.directions);
  Eigen::VectorXd split(means.groups());
  for (Eigen::Index i = 0; i < split.size(); ++i) {
    split[i] = (i % directions == 0 ? 1.0 : -1.0) / static_cast<double>(stations);
  }
  double times = 0.0;
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    const double model = split.dot(means.covariance[probe] * split);
    times += variance[static_cast<Eigen::Index>(probe)] / model / kProbes;
  }
  scatter.times = std::sqrt(std::max(times, 1.0));
  return scatter;
}

// Turns the errors and covariances of groups into the results of one component.
class ComponentEvaluation {
 public:
  ComponentEvaluation(const StationMeans& means, const SweepGauge& gauge)
      : means_(means),
        gauge_(gauge),
        directions_(std::ssize(means.directions)),
        halves_(ScatterOfHalves(means)) {}

  ComponentResult operator()(const Component& component, const Eigen::VectorXd& at_reference,
                             const Sources& reference_sources, const Eigen::VectorXd& at_target,
                             const Sources& target_sources) const {
    const SweepGauge::Kind kind = component.gauge();
    const Eigen::VectorXd groups = gauge_.Apply(kind, at_reference);
    const Eigen::MatrixXd raw_V = Sum(reference_sources);
    const Eigen::MatrixXd V = gauge_.Covariance(kind, raw_V);
    const Eigen::MatrixXd station_V = Means(V);

    ComponentResult result;
    result.component = component;
    result.value = gauge_.StationMeans(groups);
    result.u = Deviations(station_V);
    result.at_target = gauge_.StationMeans(gauge_.Apply(kind, at_target));
    result.u_at_target = Deviations(Means(gauge_.Covariance(kind, Sum(target_sources))));
    SplitDirections(groups, V, result);
    if (component.angle()) {
      result.range = Range(result.value, station_V);
    } else {
      result.straightness = Straightness(at_reference, raw_V, result.value, station_V);
    }
    double noise = 0.0;
    for (std::size_t source = 0; source < kSources; ++source) {
      result.budget[source] = OverStations(kind, reference_sources[source]);
      if (source == 0) noise = result.budget[source];
    }
    const double dof = Freedom(noise, RootMeanSquare(station_V));
    result.coverage = standards::StudentQuantile(0.975, dof);
    if (result.reversal) {
      const Uncertain& mean = result.reversal->mean;
      double beyond = Checked(means_) ? standards::StudentQuantile(1.0 - kFalseAlarm / 2.0, dof)
                                      : kBeyondUnchecked;
      if (halves_.times > 1.0) {
        const double t = standards::StudentQuantile(1.0 - kFalseAlarm / 2.0, halves_.freedom);
        beyond = std::max(beyond, t * halves_.times);
      }
      result.reversal->seen = std::abs(mean.value) > beyond * mean.u;
    }
    return result;
  }

  // The standard uncertainty from a covariance of the groups, rms over the stations.
  double OverStations(SweepGauge::Kind kind, const Eigen::MatrixXd& V) const {
    return RootMeanSquare(Means(gauge_.Covariance(kind, V)));
  }

 private:
  // Covariance of the station means from that of the groups.
  Eigen::MatrixXd Means(const Eigen::MatrixXd& V) const {
    return gauge_.StationMeans(gauge_.StationMeans(V).transpose());
  }

  void SplitDirections(const Eigen::VectorXd& groups, const Eigen::MatrixXd& V,
                       ComponentResult& result) const {
    const Eigen::Index stations = groups.size() / directions_;
    for (Eigen::Index k = 0; k < directions_; ++k) {
      Eigen::VectorXd& side = means_.directions[k] > 0 ? result.forward : result.backward;
      side.resize(stations);
      for (Eigen::Index i = 0; i < stations; ++i) side[i] = groups[i * directions_ + k];
    }
    if (directions_ != 2) return;
    // Rows: forward - backward of each station.
    Eigen::MatrixXd D = Eigen::MatrixXd::Zero(stations, groups.size());
    for (Eigen::Index i = 0; i < stations; ++i) D.row(i).segment(2 * i, 2) << 1.0, -1.0;
    const Eigen::MatrixXd reversal_V = D * V * D.transpose();
    Reversal reversal{};
    reversal.value = result.forward - result.backward;
    reversal.u = Deviations(reversal_V);
    reversal.mean = {reversal.value.mean(), std::sqrt(std::max(0.0, reversal_V.mean()))};
    Eigen::Index at = 0;
    reversal.value.cwiseAbs().maxCoeff(&at);
    reversal.largest = {reversal.value[at], reversal.u[at]};
    result.reversal = reversal;
  }

  // Largest - smallest of the values, with the uncertainty of that difference.
  static Uncertain Range(const Eigen::VectorXd& values, const Eigen::MatrixXd& V) {
    Eigen::Index high = 0, low = 0;
    const double range = values.maxCoeff(&high) - values.minCoeff(&low);
    const double variance = V(high, high) + V(low, low) - 2.0 * V(high, low);
    return {range, std::sqrt(std::max(0.0, variance))};
  }

  StraightnessFigures Straightness(const Eigen::VectorXd& raw, const Eigen::MatrixXd& raw_V,
                                   const Eigen::VectorXd& deviations,
                                   const Eigen::MatrixXd& station_V) const {
    const std::vector<double> values = ToList(deviations);
    const auto figure = [&](standards::LineKind kind) {
      const auto found = standards::EvaluateStraightness(kind, means_.stations, values);
      return LineFigure{found.line, found.error};
    };
    const Eigen::VectorXd& w = gauge_.slope_weights();
    return {.end_points = figure(standards::LineKind::kEndPoints),
            .least_squares = figure(standards::LineKind::kLeastSquares),
            .minimum_zone = figure(standards::LineKind::kMinimumZone),
            .u = Range(deviations, station_V).u,
            .slope = {w.dot(raw), std::sqrt(std::max(0.0, w.dot(raw_V * w)))}};
  }

  // Effective degrees of freedom by Welch and Satterthwaite; only the noise has finitely many.
  double Freedom(double noise, double total) const {
    if (noise <= 0.0 || means_.noise.u_dof <= 0.0) return kKnown;
    return means_.noise.u_dof * std::pow(total / noise, 4.0);
  }

  static constexpr double kKnown = 2e6;               // degrees of freedom as good as infinite
  static constexpr double kFalseAlarm = 0.01 / 15.0;  // of one reversal
  // U95 of a normal number of lognormal size (UncheckedTimes(kKnownTo)) in its rms, two-sided.
  static constexpr double kBeyondUnchecked = 7.8;

  const StationMeans& means_;
  const SweepGauge& gauge_;
  Eigen::Index directions_;
  HalfScatter halves_;
};

int PassesOf(const std::vector<Dwell>& dwells) {
  std::set<int> passes;
  for (const Dwell& dwell : dwells) passes.insert(dwell.pass);
  return static_cast<int>(passes.size());
}

}  // namespace

SweepSetup ReadSweepSetup(const settings::Table& root) {
  return {machine::ReadMachine(root), ReadHeadSettings(root), ReadTargetSettings(root),
          ReadProbeNoise(root)};
}

SweepResult ReduceSweep(const recording::Recording& recording, const SweepSetup& setup) {
  recording::RefuseOtherMachine(recording, setup.machine.name);
  const ChannelOrder order = ChannelOrderOf(recording);
  const SweepDwells sweep =
      order == kAsNamed
          ? FindDwells(recording, DwellRuleOf(recording), setup.head.Ranges())
          : FindDwells(InProbeOrder(recording, order), DwellRuleOf(recording), setup.head.Ranges());
  RefuseSlips(recording.name, sweep, setup.machine, setup.head);
  const StationMeans means = FitStations(recording.name, sweep, setup.noise, ExcessNoise::kFitted);
  const SweepInversion inversion(setup.machine, setup.head, sweep.axis, sweep.start);
  const Eigen::Index directions = means.directions.size();
  const GroupErrors errors = inversion.Errors(means.gap, means.position, directions);
  const SweepUncertainty uncertainty(setup.machine, setup.head, setup.target, sweep.axis,
                                     sweep.start, means);

  SweepResult result;
  result.recording = recording.name;
  result.machine = setup.machine.name;
  result.chain = setup.machine.chain.Text();
  result.axis = sweep.axis;
  result.moving = inversion.moving();
  result.sense = inversion.sense();
  result.positive = setup.machine.chain.ToolSense(sweep.axis) > 0.0 ? "tool" : "carriage";
  result.mounting = recording.HeaderText("mounting").value_or("");
  result.conditions = ConditionsOf(recording);
  result.stations = means.stations;
  result.passes = PassesOf(means.dwells);
  result.counts = sweep.counts;
  result.dwells = means.dwells;
  result.residual = means.residual;
  result.noise = means.noise;
  result.notes = means.notes;
  result.planned = PlannedSweepOf(recording, result.stations, result.passes);
  if (result.planned) {
    if (auto note = MissingNote(*result.planned)) result.notes.push_back(std::move(*note));
  }
  std::ranges::move(SlipNotes(sweep, means.noise, setup.noise), std::back_inserter(result.notes));
  const SweepGauge gauge(
      Eigen::Map<const Eigen::VectorXd>(means.stations.data(), means.stations.size()), directions);
  const ComponentEvaluation evaluate(means, gauge);
  PerComponent usual_linearity{};
  for (int i = 0; i < kComponents; ++i) {
    const int at_target = i + kComponents;
    result.components[i] =
        evaluate(inversion.components()[i], errors.row(i).transpose(), uncertainty.Covariance(i),
                 errors.row(at_target).transpose(), uncertainty.Covariance(at_target));
    usual_linearity[i] =
        evaluate.OverStations(inversion.components()[i].gauge(), uncertainty.UsualLinearity(i));
  }
  std::ranges::move(
      NotesOn(result, means, errors, gauge, setup.head, setup.target, usual_linearity),
      std::back_inserter(result.notes));
  return result;
}

}  // namespace abbe::probes
