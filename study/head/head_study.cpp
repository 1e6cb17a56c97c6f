#include "study/head/head_study.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "estimation/sobol_indices.h"
#include "hal/sweep_plan.h"
#include "probes/head_inversion.h"
#include "probes/head_settings.h"
#include "probes/sweep_gauge.h"
#include "probes/sweep_reduction.h"
#include "random/counter_random.h"
#include "settings/document.h"

namespace abbe::study {
namespace {

using probes::HeadErrors;
using probes::kProbes;

constexpr int kStations = 7;
using Errors = Eigen::Matrix<double, 5, kStations>;

constexpr std::array<const char*, 5> kComponents{"roll", "pitch", "yaw", "straightness along s",
                                                 "straightness along n"};
enum Factor { kMotion, kPositions, kInstallation, kGain, kNoise, kFactors };
constexpr std::array<const char*, kFactors> kFactorNames{"motion", "probe_positions",
                                                         "installation", "gains", "noise"};

// Which of two independent worlds each factor is taken from.
using Sources = std::array<int, kFactors>;

class HeadStudy : public Study {
 public:
  HeadStudy(const probes::SweepSetup& setup, const hal::SweepPlan& plan, double rate)
      : setup_(setup),
        moving_(setup.machine.chain.CarriesTarget(plan.axis) ? probes::MovingBody::kTarget
                                                             : probes::MovingBody::kHead),
        invert_(probes::InstalledLines(setup.head.layout, setup.head.installation), moving_) {
    travel_ = Eigen::VectorXd::LinSpaced(kStations, 0.0, plan.last() - plan.first());
    const double readings = 2.0 * plan.passes * std::max(1.0, plan.dwell * rate);
    for (std::size_t i = 0; i < kProbes; ++i) {
      noise_[i] = std::hypot(setup.noise.Of(i) / std::sqrt(readings),
                             setup.noise.drift / std::sqrt(plan.passes));
    }
  }

  Row World(std::uint64_t seed) const override {
    Row row;
    Eigen::Map<const Eigen::RowVectorXd> stations(travel_.data(), travel_.size());
    row["stations_m"] = std::vector<double>(stations.begin(), stations.end());
    row["one"] = ValuesOf(ErrorsOf(seed, {}));
    row["other"] = ValuesOf(ErrorsOf(seed, {1, 1, 1, 1, 1}));
    for (int factor = 0; factor < kFactors; ++factor) {
      Sources sources{};
      sources[factor] = 1;
      row[kFactorNames[factor]] = ValuesOf(ErrorsOf(seed, sources));
    }
    return row;
  }

 private:
  static std::vector<double> ValuesOf(const Errors& errors) {
    return {errors.data(), errors.data() + errors.size()};
  }

  Errors ErrorsOf(std::uint64_t seed, const Sources& sources) const {
    const auto draw = [&](Factor factor) {
      return random::CounterRandom(seed, 0x5EAD0 + 2 * factor + sources[factor]);
    };
    const probes::MeasuringLines<> lines = Made(draw(kPositions), draw(kInstallation));
    const random::CounterRandom motion = draw(kMotion), gain = draw(kGain), noise = draw(kNoise);
    Errors off;
    for (int station = 0; station < kStations; ++station) {
      const double d = travel_[station];
      const HeadErrors<> truth = MotionAt(motion, station);
      probes::PerProbe<> delta = probes::RigidReadings(lines, moving_, truth, d);
      for (std::size_t i = 0; i < kProbes; ++i) {
        delta[i] *= 1.0 + setup_.head.tolerance.gain * gain.Normal(i);
        delta[i] += noise_[i] * noise.Normal(kProbes * station + i);
      }
      const HeadErrors<> found = invert_(delta, d);
      off.col(station) << found.eax - truth.eax, found.ebx - truth.ebx, found.ecx - truth.ecx,
          found.eyx - truth.eyx, found.ezx - truth.ezx;
    }
    const probes::SweepGauge gauge(travel_, 1);
    using Kind = probes::SweepGauge::Kind;
    off.topRows<3>() = gauge.Apply(Kind::kFirstStation, off.topRows<3>().transpose()).transpose();
    off.bottomRows<2>() = gauge.Apply(Kind::kLine, off.bottomRows<2>().transpose()).transpose();
    return off;
  }

  // The head as it was made and mounted.
  probes::MeasuringLines<> Made(const random::CounterRandom& positions,
                                const random::CounterRandom& mounted) const {
    const probes::HeadTolerance& tolerance = setup_.head.tolerance;
    probes::HeadLayout<> layout = setup_.head.layout;
    std::uint64_t at = 0;
    const auto moved = [&] { return tolerance.probe_position * positions.Normal(at++); };
    for (auto& [u, s] : layout.top) u += moved(), s += moved();
    for (auto& [u, n] : layout.side) u += moved(), n += moved();
    probes::Installation<> installation = setup_.head.installation;
    installation.roll += tolerance.installation * mounted.Normal(0);
    installation.pitch += tolerance.installation * mounted.Normal(1);
    installation.yaw += tolerance.installation * mounted.Normal(2);
    installation.du += tolerance.offset * mounted.Normal(3);
    installation.ds += tolerance.offset * mounted.Normal(4);
    installation.dn += tolerance.offset * mounted.Normal(5);
    return probes::InstalledLines(layout, installation);
  }

  HeadErrors<> MotionAt(const random::CounterRandom& motion, int station) const {
    const machine::Population& population = setup_.machine.population;
    const auto normal = [&](int component) { return motion.Normal(5 * station + component); };
    return {.eax = population.roll * normal(0),
            .ebx = population.pitch * normal(1),
            .ecx = population.yaw * normal(2),
            .eyx = population.straightness * normal(3),
            .ezx = population.straightness * normal(4)};
  }

  probes::SweepSetup setup_;
  probes::MovingBody moving_;
  probes::RigidInversion invert_;
  Eigen::VectorXd travel_;    // m: of the stations
  probes::PerProbe<> noise_;  // m: of the mean at a station
};

std::unique_ptr<const Study> MakeHeadStudy(const Question& question) {
  const auto document = settings::Document::Read(question.machine);
  const settings::Table root = document.Root();
  const double rate = root.Child("devices").Quantity("rate_hz", {.fallback = 200.0, .above = 0.0});
  return std::make_unique<HeadStudy>(
      probes::ReadSweepSetup(root),
      hal::ReadSweepPlan(root.Child("sweep"), question.variant.front()), rate);
}

// Rows of a store: one column of 5 x stations values each.
Eigen::MatrixXd ColumnsOf(const std::vector<Row>& rows, const char* key) {
  Eigen::MatrixXd columns(5 * kStations, std::ssize(rows));
  for (Eigen::Index i = 0; i < columns.cols(); ++i) {
    const std::vector<double> values = NumbersOf(rows[i], key, 5 * kStations);
    columns.col(i) = Eigen::Map<const Eigen::VectorXd>(values.data(), columns.rows());
  }
  return columns;
}

// Half the width of what 95 % of the worlds lie in, about zero.
double Band(const Eigen::RowVectorXd& values) {
  std::vector<double> sizes(values.size());
  std::ranges::transform(values, sizes.begin(), [](double value) { return std::abs(value); });
  const auto at = sizes.begin() + static_cast<std::ptrdiff_t>(0.95 * (std::ssize(sizes) - 1));
  std::ranges::nth_element(sizes, at);
  return *at;
}

std::string BandsText(const std::vector<Row>& rows, const Eigen::MatrixXd& worlds) {
  std::string text =
      "What 95 % of heads stay within, angles in urad, straightness in um:\n\n| d, mm |";
  for (const char* component : kComponents) text += fmt::format(" {} |", component);
  text += "\n|---|---|---|---|---|---|\n";
  const std::vector<double> stations = NumbersOf(rows.front(), "stations_m", kStations);
  for (int station = 0; station < kStations; ++station) {
    text += fmt::format("| {:.4g} |", 1e3 * stations[station]);
    for (int c = 0; c < 5; ++c)
      text += fmt::format(" {:.3g} |", 1e6 * Band(worlds.row(5 * station + c)));
    text += "\n";
  }
  return text;
}

// The indices of one component, all its stations together.
estimation::SobolResult SharesOf(const std::vector<Row>& rows, int component) {
  const auto at_stations = [&](const Row& row, const char* key) {
    const std::vector<double> all = NumbersOf(row, key, 5 * kStations);
    std::vector<double> values;
    for (int station = 0; station < kStations; ++station) {
      values.push_back(all[5 * station + component]);
    }
    return values;
  };
  estimation::SobolSums sums(kFactors, std::vector<double>(kStations, 0.0));
  for (const Row& row : rows) {
    const auto one = at_stations(row, "one"), other = at_stations(row, "other");
    auto draw = sums.Add(one, other);
    for (int factor = 0; factor < kFactors; ++factor) {
      draw.Add(factor, at_stations(row, kFactorNames[factor]));
    }
  }
  return sums.Result();
}

std::string SharesText(const std::vector<Row>& rows) {
  std::array<estimation::SobolResult, 5> of;
  for (int c = 0; c < 5; ++c) of[c] = SharesOf(rows, c);
  std::string text =
      "Share of each factor in the variance (total index, +- U95), over all stations:\n\n| factor |";
  for (const char* component : kComponents) text += fmt::format(" {} |", component);
  text += "\n|---|---|---|---|---|---|\n";
  for (int factor = 0; factor < kFactors; ++factor) {
    std::string name = kFactorNames[factor];
    std::ranges::replace(name, '_', ' ');
    text += fmt::format("| {} |", name);
    for (const auto& component : of) {
      const estimation::SobolIndex& index = component.inputs[factor];
      text += fmt::format(" {:.3f} +- {:.3f} |", index.total, 2.0 * index.total_uncertainty);
    }
    text += "\n";
  }
  return text;
}

Summary SumHeadStudy(const std::string& /*variant*/, const std::vector<Row>& rows) {
  const Eigen::MatrixXd one = ColumnsOf(rows, "one"), other = ColumnsOf(rows, "other");
  Eigen::MatrixXd both(one.rows(), one.cols() + other.cols());
  both << one, other;
  return {.text = BandsText(rows, both) + "\n" + SharesText(rows), .bounds = {}};
}

}  // namespace

const StudyKind kHeadStudy{.name = "head",
                           .what =
                               "What the tolerances of the head leave of a sweep, and which "
                               "of them matters how much",
                           .variants = {"X", "Y", "Z"},
                           .make = MakeHeadStudy,
                           .sum = SumHeadStudy};

}  // namespace abbe::study
