#include "probes/sweep_reduction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "failure/failure.h"
#include "probes/channel_order.h"
#include "probes/sweep_slips.h"
#include "probes/sweep_stations.h"
#include "recording/made_on.h"
#include "standards/straightness.h"
#include "standards/student_coverage.h"

namespace abbe::probes {
namespace {

using Sources = std::array<Eigen::MatrixXd, kSources>;
using PerComponent = std::array<double, kComponents>;

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

// The effect of an error in the position of the head, in um per mm: the straightness that the
// measured angles produce at the end of such a lever.
std::string LeverText(const SweepResult& result, const GroupErrors& errors,
                      const SweepGauge& gauge) {
  std::string text;
  for (std::size_t i = 3; i < kComponents; ++i) {
    const std::string& name = result.components[i].component.name;
    const int across = name[1] - 'X';
    text += fmt::format("{}{} by", text.empty() ? "" : " and ", name);
    for (int along = 0; along < 3; ++along) {
      // -(w x e) in the direction `across`, w the rows 0 to 2 of the errors.
      Eigen::VectorXd moved = Eigen::VectorXd::Zero(errors.cols());
      if (along != across) {
        const double sign = (along + 1) % 3 == across ? -1.0 : 1.0;
        moved = sign * errors.row(3 - along - across).transpose();
      }
      const Eigen::VectorXd bow = gauge.StationMeans(gauge.Apply(SweepGauge::Kind::kLine, moved));
      text += fmt::format("{} {:.2g}", along == 0 ? "" : ",",
                          (bow.maxCoeff() - bow.minCoeff()) * 1e3);  // um per mm
    }
  }
  return text;
}

// How much rests on the stated form of the target, which one sweep cannot check.
std::optional<std::string> FormNote(const TargetSettings& target, const SweepResult& result) {
  constexpr double kMatters = 0.1;  // of a variance
  constexpr double kTimes = 3.0;
  constexpr std::size_t kForm = kSources - 1;
  if (target.form_known_to == 1.0) return std::nullopt;
  double most = 0.0;
  std::string name;
  for (const ComponentResult& component : result.components) {
    double all = 0.0;
    for (const double source : component.budget) all += source * source;
    const double share = all > 0.0 ? std::pow(component.budget[kForm], 2) / all : 0.0;
    if (share <= most) continue;
    most = share;
    name = component.component.name;
  }
  if (most < kMatters) return std::nullopt;
  const double flatter = std::pow(UncheckedTimes(target.form_known_to), -2);
  return fmt::format(
      "{:.0f} % of the variance of {} rests on target.form_nm = {:.3g}, which one sweep cannot check: "
      "u holds it as known to a factor of {:.3g}; on a target with {:.0f} times that form U95 would "
      "be {:.1f} times as large. Measure the flatness of the faces and state it with form_known_to "
      "= 1, or sweep once more with the target shifted or reversed and fuse",
      100.0 * most, name, target.form * 1e9, target.form_known_to, kTimes,
      std::sqrt(1.0 + most * (kTimes * kTimes * flatter - 1.0)));
}

// What probes of usual linearity would add where the machine file does not state it.
std::optional<std::string> LinearityNote(const HeadSettings& head, const SweepResult& result,
                                         const PerComponent& usual) {
  constexpr double kMatters = 1.5;  // of a U95
  if (!head.assumed.contains("head.tolerance.linearity_um")) return std::nullopt;
  double most = 0.0;
  std::string name;
  for (std::size_t i = 0; i < usual.size(); ++i) {
    const auto& budget = result.components[i].budget;
    const double all = std::inner_product(budget.begin(), budget.end(), budget.begin(), 0.0);
    const double times = all > 0.0 ? std::sqrt(1.0 + usual[i] * usual[i] / all) : 1.0;
    if (times <= most) continue;
    most = times;
    name = result.components[i].component.name;
  }
  if (most < kMatters) return std::nullopt;
  return fmt::format(
      "the linearity of the probes is not in u: of 0.1 % of their range, which is usual, U95 of {} "
      "would be {:.1f} times as large over these gaps; state head.tolerance.linearity_um by their "
      "certificate (its limit / 1.7), 0 where their characteristics are corrected",
      name, most);
}

// What the directions of the sweep leave open: the reversal.
std::optional<std::string> DirectionNote(const StationMeans& means, const SweepResult& result) {
  if (means.directions.size() == 1) {
    return fmt::format(
        "the sweep has {} passes only: the errors are those of this direction, and u holds no "
        "reversal; the mean of both directions, as ISO 230-1 states it, differs by half the "
        "reversal; record passes in both",
        means.directions.front() > 0 ? "forward" : "backward");
  }
  if (Checked(means)) return std::nullopt;
  std::string names;
  for (const ComponentResult& component : result.components) {
    if (!component.reversal->seen) continue;
    names += (names.empty() ? "" : ", ") + component.component.name;
  }
  if (names.empty()) return std::nullopt;
  return fmt::format(
      "one pass: forward and backward of {} differ by more than noise and drift, but a probe that "
      "jumps at the turn looks like that reversal; a second pass tells",
      names);
}

std::vector<std::string> AssumptionNotes(const HeadSettings& head, const SweepResult& result,
                                         const GroupErrors& errors, const SweepGauge& gauge) {
  std::vector<std::string> notes;
  const std::string place = fmt::format("head.axis_{}.position_mm", result.axis);
  if (head.assumed.contains(place)) {
    notes.push_back(
        fmt::format("{} is not in the machine file and is taken as [0, 0, 0]: each mm of it in x, "
                    "y, z moves {} um; state it",
                    place, LeverText(result, errors, gauge)));
  }
  const std::string turn = fmt::format("head.axis_{}.rotation", result.axis);
  if (head.assumed.contains(turn)) {
    notes.push_back(fmt::format(
        "{} is not in the machine file: a head that stands otherwise changes names and signs of "
        "the errors; state it",
        turn));
  }
  const auto placed = [&](char probe) {
    return !head.assumed.contains(fmt::format("head.probe_{}.position_mm", probe));
  };
  if (!std::ranges::all_of(std::string_view("abcde"), placed)) {
    notes.push_back(
        "probes without position_mm are taken to stand as drawn, 10 and 20 mm from the edge: 1 % "
        "of it moves an angle by 1 %; state them");
  }
  return notes;
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
  if (auto note = DirectionNote(means, result)) result.notes.push_back(std::move(*note));
  if (auto note = FormNote(setup.target, result)) result.notes.push_back(std::move(*note));
  if (auto note = LinearityNote(setup.head, result, usual_linearity)) {
    result.notes.push_back(std::move(*note));
  }
  std::ranges::move(AssumptionNotes(setup.head, result, errors, gauge),
                    std::back_inserter(result.notes));
  return result;
}

}  // namespace abbe::probes
