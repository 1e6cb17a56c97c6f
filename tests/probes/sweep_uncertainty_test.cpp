// GUM first order against GUM Supplement 1: every source is drawn and goes through the exact
// inversion.
#include "probes/sweep_uncertainty.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "estimation/monte_carlo.h"
#include "probes/sweep_stations.h"
#include "random/counter_random.h"
#include "tests/probes/synthetic_sweep.h"

namespace abbe::probes {
namespace sweep_uncertainty_test {

// A square root of a covariance that may be singular: V = L L^T.
Eigen::MatrixXd RootOf(const Eigen::MatrixXd& V) {
  const Eigen::LDLT<Eigen::MatrixXd> ldlt(V);
  Eigen::MatrixXd L = ldlt.matrixL();
  L = ldlt.transpositionsP().transpose() * L;
  return L * ldlt.vectorD().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

// A draw of everything that is uncertain about one sweep.
class SweepDraws {
 public:
  SweepDraws(const SweepSetup& setup, const SweepDwells& sweep, const StationMeans& means)
      : setup_(setup), sweep_(sweep), means_(means) {
    for (std::size_t p = 0; p < kProbes; ++p) noise_[p] = RootOf(means.covariance[p]);
    const Eigen::Index groups = means.groups();
    const double sense = setup.machine.chain.CarriesTarget(sweep.axis) ? -1.0 : 1.0;
    std::vector<Eigen::Vector3d> places;  // u and across on a face, and which face
    for (std::size_t p = 0; p < kProbes; ++p) {
      for (Eigen::Index g = 0; g < groups; ++g) {
        const double d = means.position[g] - sweep.start[sweep.axis - 'X'];
        const auto& layout = setup.head.layout;
        places.push_back(
            p < 3 ? Eigen::Vector3d(layout.top[p].u + sense * d, layout.top[p].s, 0.0)
                  : Eigen::Vector3d(layout.side[p - 3].u + sense * d, layout.side[p - 3].n, 1.0));
      }
    }
    const auto n = static_cast<Eigen::Index>(places.size());
    Eigen::MatrixXd V(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j < n; ++j) {
        const Eigen::Vector3d& a = places[static_cast<std::size_t>(i)];
        const Eigen::Vector3d& b = places[static_cast<std::size_t>(j)];
        const double distance = (a - b).head<2>().norm() / setup.target.form_length;
        V(i, j) = a.z() == b.z()
                      ? std::pow(setup.target.form, 2) * std::exp(-distance * distance / 2)
                      : 0.0;
      }
    }
    form_ = RootOf(V);
    for (std::size_t p = 0; p < kProbes; ++p) {
      Eigen::MatrixXd departs(groups, groups);
      for (Eigen::Index g = 0; g < groups; ++g) {
        for (Eigen::Index h = 0; h < groups; ++h) {
          const auto row = static_cast<Eigen::Index>(p);
          const double lengths = (means.gap(row, g) - means.gap(row, h)) / (200e-6 / 16.0);
          departs(g, h) =
              std::pow(setup.head.tolerance.linearity, 2) * std::exp(-lengths * lengths / 2.0);
        }
      }
      departs_[p] = RootOf(departs);
    }
  }

  // The errors of draw `draw`, not gauged.
  GroupErrors Errors(std::uint64_t draw) const {
    const random::CounterRandom random(draw, 7);
    std::uint64_t index = 0;
    const auto normal = [&] { return random.Normal(index++); };
    const auto normals = [&](Eigen::Index n) {
      return Eigen::VectorXd(
          Eigen::VectorXd::NullaryExpr(n, [&](Eigen::Index) { return normal(); }));
    };
    HeadSettings head = setup_.head;
    const HeadTolerance& tolerance = head.tolerance;
    GroupReadings gaps = means_.gap;
    const Eigen::VectorXd form = form_ * normals(form_.cols());
    const Eigen::Index groups = means_.groups();
    for (std::size_t p = 0; p < kProbes; ++p) {
      const auto row = static_cast<Eigen::Index>(p);
      gaps.row(row) += (noise_[p] * normals(groups)).transpose();
      gaps.row(row) += (departs_[p] * normals(groups)).transpose();
      gaps.row(row) -= form.segment(row * groups, groups).transpose();
      head.probes[p].gain += tolerance.gain * normal();
    }
    for (auto& top : head.layout.top) {
      top.u += tolerance.probe_position * normal();
      top.s += tolerance.probe_position * normal();
    }
    for (auto& side : head.layout.side) {
      side.u += tolerance.probe_position * normal();
      side.n += tolerance.probe_position * normal();
    }
    Installation<>& i = head.installation;
    for (double* angle : {&i.roll, &i.pitch, &i.yaw}) *angle += tolerance.installation * normal();
    for (double* offset : {&i.du, &i.ds, &i.dn}) *offset += tolerance.offset * normal();
    return SweepInversion(setup_.machine, head, sweep_.axis, sweep_.start)
        .Errors(gaps, means_.position, static_cast<Eigen::Index>(means_.directions.size()));
  }

 private:
  const SweepSetup& setup_;
  const SweepDwells& sweep_;
  const StationMeans& means_;
  PerProbe<Eigen::MatrixXd> noise_, departs_;
  Eigen::MatrixXd form_;
};

// The sizes of 1e5 targets that are known to a factor of two, the form of each at one place.
TEST(SweepUncertainty, ASizeKnownToAFactorKeepsItsCoverage) {
  const random::CounterRandom random(1, 1);
  constexpr std::uint64_t kDraws = 100000;
  double squares = 0.0, inside = 0.0;
  for (std::uint64_t i = 0; i < kDraws; ++i) {
    const double form = std::exp(std::log(2.0) * random.Normal(2 * i)) * random.Normal(2 * i + 1);
    squares += form * form / kDraws;
    inside += std::abs(form) < 1.96 * UncheckedTimes(2.0) ? 1.0 / kDraws : 0.0;
  }
  EXPECT_NEAR(std::sqrt(squares) / UncheckedTimes(2.0), 1.0, 0.05);
  EXPECT_NEAR(inside, 0.95, 0.008);
  EXPECT_DOUBLE_EQ(UncheckedTimes(1.0), 1.0);
}

void CheckAgainstMonteCarlo(char axis, MovingBody moving) {
  SweepSetup setup = TestSetup();
  setup.target.form_known_to = 1.0;  // all draws are of the form that is stated
  setup.head.tolerance.linearity = 50e-9;
  // A target tilted by 0.5 mrad makes the gains matter.
  const SyntheticSweep wanted{.axis = axis,
                              .moving = moving,
                              .step = 15e-3,
                              .stations = 5,
                              .passes = 2,
                              .white = 20e-9,
                              .drift = 30e-9,
                              .tilt_s = 0.5e-3,
                              .tilt_n = -0.4e-3};
  const recording::Recording recording = Record(wanted, setup);
  const SweepResult result = ReduceSweep(recording, setup);
  PerProbe<> ranges;
  ranges.fill(200e-6);
  const SweepDwells sweep = FindDwells(recording, DwellRuleOf(recording), ranges);
  const StationMeans means = FitStations("", sweep, setup.noise, ExcessNoise::kFitted);
  const SweepDraws draws(setup, sweep, means);
  const SweepGauge gauge(Eigen::Map<const Eigen::VectorXd>(means.stations.data(), 5), 2);

  // Outputs: each component at each station, at the reference; then the reversal of each at
  // station 3.
  const auto propagated = estimation::PropagateDistributions(
      kComponents * 6,
      [&](std::uint64_t draw, std::span<double> out) {
        const GroupErrors errors = draws.Errors(draw);
        for (std::size_t c = 0; c < kComponents; ++c) {
          const Eigen::VectorXd groups =
              gauge.Apply(result.components[c].component.gauge(),
                          errors.row(static_cast<Eigen::Index>(c)).transpose());
          for (std::size_t i = 0; i < 5; ++i) {
            const auto g = static_cast<Eigen::Index>(2 * i);
            out[6 * c + i] = (groups[g] + groups[g + 1]) / 2.0;
          }
          out[6 * c + 5] = groups[6] - groups[7];
        }
      },
      {.max_blocks = 10, .threads = 2});
  // 1e5 draws give a standard deviation to 0.2 %; second order in the tolerances (1e-3) is
  // neglected.
  constexpr double kRelative = 0.015;
  for (std::size_t c = 0; c < kComponents; ++c) {
    const ComponentResult& component = result.components[c];
    const double floor = component.component.angle() ? 1e-12 : 1e-14;
    for (std::size_t i = 0; i < 5; ++i) {
      const double drawn = propagated.outputs[6 * c + i].standard_uncertainty;
      EXPECT_NEAR(component.u[static_cast<Eigen::Index>(i)], drawn, kRelative * drawn + floor)
          << component.component.name << " station " << i;
    }
    const double drawn = propagated.outputs[6 * c + 5].standard_uncertainty;
    EXPECT_NEAR(component.reversal->u[3], drawn, kRelative * drawn + floor);
  }
}

TEST(SweepUncertainty, AgreesWithMonteCarloForAMovingTarget) {
  CheckAgainstMonteCarlo('X', MovingBody::kTarget);
}

TEST(SweepUncertainty, AgreesWithMonteCarloForAMovingHead) {
  CheckAgainstMonteCarlo('Z', MovingBody::kHead);
}

}  // namespace sweep_uncertainty_test
}  // namespace abbe::probes
