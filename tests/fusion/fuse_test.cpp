// The joint estimate against the virtual rig, which shares no code with it.
#include "fusion/fuse.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "random/counter_random.h"
#include "tests/fusion/rig_campaign.h"

namespace abbe::fusion {
namespace {

using simulation::SimulatedRun;

void Print(const FuseReport& report) {
  for (const auto& f : report.functions) {
    fmt::print("{} prior {:.3f} u {:.3f}  {}\n", f.name, 1e6 * f.prior, 1e6 * f.u,
               fmt::join(f.determined_by, " "));
  }
  fmt::print("scale {:.2f} +- {:.2f} ppm, prior {:.2f}, calibrated {}\n", 1e6 * report.scale.value,
             1e6 * report.scale.u, 1e6 * report.scale.prior, report.scale.calibrated);
  for (const auto& s : report.smoothness)
    fmt::print("smoothness {:.1f} mm: {:.2f}\n", 1e3 * s.length, s.log_evidence);
  for (const auto& r : report.runs)
    fmt::print("{}: T {:.1f} of {} p {:.3g}\n", r.name, r.statistic, r.directions, r.probability);
  for (const auto& s : report.fit.sources)
    fmt::print("source {} rows {} chi2 {:.1f} redundancy {:.1f}\n", s.name, s.rows, s.chi_square,
               s.redundancy);
  fmt::print("iterations {}\n", report.fit.iterations);
}

struct MapErrors {
  double rms = 0, stated = 0, pull = 0;
};
MapErrors Judge(const Campaign& campaign, const FuseReport& report) {
  const random::CounterRandom random(campaign.rig.world().seed(), 4711);
  MapErrors sum;
  constexpr int kPoints = 200;
  for (int i = 0; i < kPoints; ++i) {
    Eigen::Vector3d axes;
    for (int k = 0; k < 3; ++k)
      axes[k] = random.Uniform(static_cast<std::uint64_t>(3 * i + k), 0.0, 0.06);
    const Eigen::Vector3d off = report.map.Error(axes, Eigen::Vector3d::Zero()) -
                                campaign.TrueError(axes) + campaign.TrueError({0, 0, 0});
    const Eigen::Vector3d u = report.map.StandardUncertainty(axes, Eigen::Vector3d::Zero());
    sum.rms += off.squaredNorm() / kPoints;
    sum.stated += u.squaredNorm() / kPoints;
    sum.pull += off.cwiseQuotient(u).squaredNorm() / (3 * kPoints);
  }
  return {std::sqrt(sum.rms), std::sqrt(sum.stated), std::sqrt(sum.pull)};
}

TEST(Fuse, Sweeps) {
  const std::vector<std::vector<std::pair<std::string, std::string>>> cases{
      {},
      {{"form_nm = 10.0", "form_nm = 0.0"}},
      {{"drift_nm = 30.0", "drift_nm = 0.0"}},
      {{"drift_nm = 30.0", "drift_nm = 0.0"}, {"form_nm = 10.0", "form_nm = 0.0"}},
      {{"drift_nm = 30.0", "drift_nm = 0.0"}, {"form_nm = 10.0", "form_nm = 0.0"}, {"gain_ppm = 500.0", "gain_ppm = 0.0"}},
      {{"drift_nm = 30.0", "drift_nm = 0.0"}, {"form_nm = 10.0", "form_nm = 0.0"}, {"gain_ppm = 500.0", "gain_ppm = 0.0"}, {"probe_position_um = 10.0", "probe_position_um = 0.0"}, {"installation_urad = 500.0", "installation_urad = 0.0"}, {"installation_um = 50.0", "installation_um = 0.0"}},
  };
  for (const auto& changes : cases) {
    const settings::Document document = CampaignMachine(changes);
    double chi[3] = {0, 0, 0}, red[3] = {0, 0, 0};
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const Campaign campaign(document, seed);
      const FuseReport report = Fuse(campaign.machine, {campaign.Sweep('X'), campaign.Sweep('Y'), campaign.Sweep('Z')}, {.choose_smoothness = false});
      for (int i = 0; i < 3; ++i) {
        chi[i] += report.fit.sources[i].chi_square;
        red[i] += report.fit.sources[i].redundancy;
      }
    }
    fmt::print("case {}: {:.3f} {:.3f} {:.3f}\n", changes.size(), chi[0] / red[0], chi[1] / red[1], chi[2] / red[2]);
  }
}

TEST(Fuse, Prototype) {
  const settings::Document document = CampaignMachine();
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Campaign campaign(document, seed);
    const std::vector<SimulatedRun> sweeps{campaign.Sweep('X'), campaign.Sweep('Y'),
                                           campaign.Sweep('Z')};
    const SimulatedRun linkage = campaign.Linkage();
    const SimulatedRun length = campaign.Length('X');
    std::vector<std::vector<SimulatedRun>> sets{sweeps, {linkage}, sweeps, sweeps};
    sets[2].push_back(linkage);
    sets[3].push_back(linkage);
    sets[3].push_back(length);
    for (const auto& runs : sets) {
      const FuseReport report = Fuse(campaign.machine, runs, {});
      const MapErrors e = Judge(campaign, report);
      fmt::print("seed {} runs {}: map rms {:.3f} um, stated {:.3f}, pull {:.2f}\n", seed,
                 runs.size(), 1e6 * e.rms, 1e6 * e.stated, e.pull);
      if (seed == 1) Print(report);
    }
  }
}

}  // namespace
}  // namespace abbe::fusion
