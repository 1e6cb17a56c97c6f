// A map that is kept true on machines of the virtual rig that drift and warm for thirty days: is it
// as uncertain as it says at all times, how good is it beside a recalibration each day, and does it
// stay as good where nothing drifts?
#include "track/tracked_map.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "failure/failure.h"
#include "map/map_file.h"
#include "random/counter_random.h"
#include "rig/ageing.h"
#include "tests/fusion/rig_campaign.h"
#include "tests/pull_statistics.h"
#include "tests/seeds.h"
#include "track/learn.h"

namespace abbe::track {
namespace tracked_map_test {

using Eigen::Vector3d;
using fusion::Campaign;
using recording::Recording;
using simulation::SimulatedRun;

constexpr double kCoverage = 1.96;
constexpr double kDay = 86400.0, kStart = 1.79e9;  // s
constexpr int kDays = 30;
constexpr double kTool = 0.05;  // m: largest coordinate of the tool vector
constexpr int kPoints = 20;     // of the rms over the volume

const char* const kDrifts =
    "[drift]\npositioning_um = 0.1\nstraightness_um = 0.05\nroll_urad = 1.0\npitch_urad = 1.0\n"
    "yaw_urad = 1.0\nsquareness_urad = 1.5\nscale_ppm = 1.0\nsmoothness_mm = 30.0\n"
    "[drift.temperature.table]\nlag_s = 10000.0\npositioning_um = 0.1\nstraightness_um = 0.05\n"
    "roll_urad = 1.0\npitch_urad = 1.0\nyaw_urad = 1.0\nsquareness_urad = 1.0\nscale_ppm = 10.0\n"
    "[rig.ageing]\npositioning_um = 0.1\nstraightness_um = 0.05\nroll_urad = 1.0\n"
    "pitch_urad = 1.0\nyaw_urad = 1.0\nsquareness_urad = 1.5\nscale_ppm = 1.0\nlag_s = 10000.0\n"
    "swing_c = 1.5\nwander_c = 1.0\n"
    "[rig.ageing.by_kelvin]\npositioning_um = 0.1\nstraightness_um = 0.05\nroll_urad = 1.0\n"
    "pitch_urad = 1.0\nyaw_urad = 1.0\nsquareness_urad = 1.0\nscale_ppm = 10.0\n";
const char* const kStill = "[drift]\npositioning_um = 0.0\nsmoothness_mm = 30.0\n";

// `form_nm`: of the target, which is the same in every sweep of an axis.
settings::Document Machine(const std::string& drift, const std::string& form_nm = "10.0") {
  return fusion::CampaignMachine({{"smoothness_mm = 15.0", "smoothness_mm = 30.0"},
                                  {"step_mm = 4.0", "step_mm = 6.0"},
                                  {"form_nm = 10.0", "form_nm = " + form_nm},
                                  {"\\[noise\\]", drift + "[noise]"}});
}

// A machine of the rig that grows older.
class OldMachine {
 public:
  OldMachine(const settings::Document& document, std::uint64_t seed)
      : campaign(document, seed),
        ageing_(rig::ReadRigSettings(document.Root()), seed),
        linkage_(rig::ReadLinkage(document.Root()), seed) {}

  void GoTo(double day) {
    day_ = day;
    campaign.rig = rig::LinkageRig(ageing_.WorldAt(day), linkage_);
  }
  double TemperatureAt(double day) const { return ageing_.TemperatureAt(day); }
  double TimeAt(double day) const { return kStart + day * kDay; }
  // `run`: of the noise.
  std::vector<Recording> FullSet(std::uint64_t run) const {
    std::vector<Recording> set{Sweep('X', run), Sweep('Y', run), Sweep('Z', run), Volume(5, run)};
    for (const char axis : {'X', 'Y', 'Z'}) set.push_back(Length(axis, run));
    return set;
  }
  // One sweep, few poses of the linkage, a length.
  std::vector<Recording> ShortTest(int day, std::uint64_t run) const {
    const char axis = "XYZ"[day % 3];
    return {Sweep(axis, run), Volume(3, run), Length(axis, run)};
  }
  std::vector<SimulatedRun> Runs(const std::vector<Recording>& set,
                                 const machine::VolumetricModel& on) const {
    std::vector<SimulatedRun> runs;
    for (const Recording& each : set) runs.push_back(campaign.Simulated(each, on));
    return runs;
  }
  fusion::FuseReport Fused(const std::vector<Recording>& set) const {
    fusion::FuseOptions options{.choose_smoothness = false, .measured = TimeAt(day_)};
    const double table = TemperatureAt(day_);
    options.sensors = {{"table", 0.0, table, table}};
    return fusion::Fuse(campaign.machine, Runs(set, campaign.model), options);
  }

  Campaign campaign;

 private:
  Recording Sweep(char axis, std::uint64_t run) const { return campaign.SweepRecording(axis, run); }
  Recording Volume(int points, std::uint64_t run) const {
    Recording volume = campaign.LinkageRecording(points, run);
    volume.name = "volume";
    return volume;
  }
  Recording Length(char axis, std::uint64_t run) const {
    Recording length = rig::RecordLengths(
        campaign.rig, {.axis = axis, .at = Vector3d::Constant(0.030), .run = run});
    length.name = fmt::format("length {}", axis);
    return length;
  }

  rig::Ageing ageing_;
  rig::Linkage linkage_;
  double day_ = 0.0;
};

// An operator's time: what the recordings last, and a quarter of an hour to set up head, linkage or
// interferometer.
double MinutesOf(const std::vector<Recording>& set) {
  double minutes = 0.0;
  for (const Recording& each : set) {
    const auto time = each.At("time_s");
    minutes += (time.back() - time.front()) / 60.0;
  }
  return minutes;
}

Vector3d Draw(const random::CounterRandom& random, std::uint64_t first, double low, double high) {
  return {random.Uniform(first, low, high), random.Uniform(first + 1, low, high),
          random.Uniform(first + 2, low, high)};
}

double SquareOff(const map::ErrorMap& map, const OldMachine& mill, std::uint64_t seed) {
  const random::CounterRandom random(seed, 0x7A1);
  Mean square;
  for (std::uint64_t i = 0; i < kPoints; ++i) {
    const Vector3d at = Draw(random, 3 * i, 0.0, 0.06);
    square.Add((map.Error(at, Vector3d::Zero()) - mill.campaign.TrueError(at)).squaredNorm());
  }
  return square.mean();
}

// One random point, tool and component of the map.
void Judge(const map::ErrorMap& map, const OldMachine& mill, std::uint64_t seed, std::uint64_t when,
           Pulls& pulls) {
  const random::CounterRandom random(seed, 0x7A2 + when);
  const Vector3d at = Draw(random, 0, 0.0, 0.06), tool = Draw(random, 3, -kTool, kTool);
  const auto component = static_cast<Eigen::Index>(3.0 * random.Uniform(6, 0.0, 1.0));
  const Vector3d off = map.Error(at, tool) - mill.campaign.TrueError(at, tool);
  pulls.Add(off[component], map.StandardUncertainty(at, tool)[component], kCoverage);
}

// A difference of errors of the map, which is linear in its parameters.
class Difference {
 public:
  Difference(const map::ErrorMap& map, const OldMachine& mill)
      : map_(map), mill_(mill), by_parameters_(map.model().ParameterCount()) {
    by_parameters_.setZero();
  }
  void Add(double times, const Vector3d& at, const Vector3d& tool, Eigen::Index component) {
    const auto linear = map_.model().Linearize(at, tool);
    off_ += times * (linear.error - mill_.campaign.TrueError(at, tool))[component];
    by_parameters_ += times * linear.J_error_parameters.row(component);
  }
  void JudgeInto(Pulls& pulls) const {
    pulls.Add(off_, std::sqrt(by_parameters_.dot(by_parameters_ * map_.cov_pp())), kCoverage);
  }

 private:
  const map::ErrorMap& map_;
  const OldMachine& mill_;
  double off_ = 0.0;
  Eigen::RowVectorXd by_parameters_;
};

// Each axis from end to end, and its middle against the ends: how it positions, how straight it
// is, how it turns.
constexpr std::array kKinds{"scale",        "positioning",        "squareness, ends",
                            "straightness", "angles, end to end", "angles, middle"};
using ByKind = std::array<Pulls, kKinds.size()>;

void JudgeKinds(const map::ErrorMap& map, const OldMachine& mill, ByKind& pulls) {
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const Vector3d start = Vector3d::Zero(), end = 0.06 * Vector3d::Unit(axis), middle = 0.5 * end;
    for (Eigen::Index component = 0; component < 3; ++component) {
      const std::size_t linear = component == axis ? 0 : 2;
      const Vector3d arm = kTool * Vector3d::Unit((component + 1) % 3);
      for (const Vector3d& tool : {Vector3d::Zero().eval(), arm}) {
        const bool turns = tool.norm() > 0.0;
        Difference whole(map, mill), bow(map, mill);
        for (const double times : {1.0, -1.0}) {
          if (times < 0.0 && !turns) continue;
          const Vector3d with = times > 0.0 ? tool : Vector3d::Zero().eval();
          whole.Add(times, end, with, component);
          whole.Add(-times, start, with, component);
          bow.Add(times, middle, with, component);
          bow.Add(-0.5 * times, start, with, component);
          bow.Add(-0.5 * times, end, with, component);
        }
        whole.JudgeInto(pulls[turns ? 4 : linear]);
        bow.JudgeInto(pulls[turns ? 5 : linear + 1]);
      }
    }
  }
}

// The hours of the log from one day to another.
void FollowLog(const OldMachine& mill, double from, double to, TrackedMap& tracked) {
  for (int hour = static_cast<int>(std::floor(from * 24.0)) + 1; hour <= to * 24.0 + 1e-9; ++hour) {
    const double day = hour / 24.0;
    tracked.Follow({mill.TimeAt(day), {{"table", mill.TemperatureAt(day)}}});
  }
}

double Root(const Mean& mean) { return 1e6 * std::sqrt(mean.mean()); }

// The share of U95 over a month of one machine after the other.
Mean RunMonths(const std::string& form_nm) {
  const settings::Document document = Machine(kDrifts, form_nm);
  const machine::Drift drift = machine::ReadDrift(document.Root());
  const Seeds seeds = SeedsFromEnvironment();
  Pulls before, after, between;
  std::array<Pulls, 3> by_time;  // thirds of the month
  ByKind by_kind;
  Mean tracked_square, full_square, stale_square, coverage;
  double short_minutes = 0.0, full_minutes = 0.0;
  int refused = 0;
  for (std::uint64_t seed = seeds.first; seed <= seeds.last; seed += seeds.step) {
    OldMachine mill(document, seed);
    mill.GoTo(0.0);
    const auto full = mill.FullSet(1);
    const map::ErrorMap stale = mill.Fused(full).map;
    TrackedMap tracked(mill.campaign.machine, stale, drift);
    Pulls of_machine;
    for (int day = 1; day <= kDays; ++day) {
      const auto when = static_cast<std::uint64_t>(10 * day);
      // Half a day before, the morning before the test, and after it.
      FollowLog(mill, day - 1.0, day - 0.5, tracked);
      mill.GoTo(day - 0.5);
      map::ErrorMap now = tracked.Map();
      Judge(now, mill, seed, when, between);
      Judge(now, mill, seed, when, of_machine);
      FollowLog(mill, day - 0.5, day, tracked);
      mill.GoTo(day);
      now = tracked.Map();
      Judge(now, mill, seed, when + 1, before);
      Judge(now, mill, seed, when + 1, of_machine);
      const auto test = mill.ShortTest(day, static_cast<std::uint64_t>(100 + day));
      short_minutes += MinutesOf(test);
      full_minutes += MinutesOf(full);
      for (const Recording& each : test) {
        try {
          tracked.Take(mill.Runs({each}, stale.model()), mill.TimeAt(day));
        } catch (const InputError&) {
          ++refused;  // p below 1e-3 happens by chance
        }
      }
      now = tracked.Map();
      Judge(now, mill, seed, when + 2, after);
      Judge(now, mill, seed, when + 2, of_machine);
      Judge(now, mill, seed, when + 3, by_time[static_cast<std::size_t>((day - 1) / 10)]);
      JudgeKinds(now, mill, by_kind);
      tracked_square.Add(SquareOff(now, mill, seed));
      stale_square.Add(SquareOff(stale, mill, seed));
      if (day % 10 == 0) {
        full_square.Add(SquareOff(
            mill.Fused(mill.FullSet(static_cast<std::uint64_t>(200 + day))).map, mill, seed));
      }
    }
    coverage.Add(of_machine.inside.mean());
  }
  const auto tell = [](const std::string& name, const Pulls& pulls) {
    fmt::print("{:<24}{:>8.3f}{:>10.3f}{:>8.1f}%\n", name, pulls.pull.mean(), pulls.square.mean(),
               100.0 * pulls.inside.mean());
  };
  fmt::print("{:<24}{:>8}{:>10}{:>9}\n", "", "pull", "variance", "in U95");
  tell("half a day before", between);
  tell("before a test", before);
  tell("after it", after);
  for (std::size_t third = 0; third < by_time.size(); ++third) {
    tell(fmt::format("after, days {} to {}", 10 * third + 1, 10 * third + 10), by_time[third]);
  }
  for (std::size_t kind = 0; kind < kKinds.size(); ++kind) tell(kKinds[kind], by_kind[kind]);
  fmt::print("all together, machine by machine {:.2f} +- {:.2f} %\n", 100.0 * coverage.mean(),
             100.0 * coverage.error());
  fmt::print("refused {} of {} recordings\n", refused, 3 * kDays * coverage.count);
  fmt::print("rms um: tracked {:.3f}, a recalibration each day {:.3f}, the map of day 0 {:.3f}\n",
             Root(tracked_square), Root(full_square), Root(stale_square));
  fmt::print("minutes a day: {:.2f} of {:.2f}\n", short_minutes / (kDays * coverage.count),
             full_minutes / (kDays * coverage.count));
  EXPECT_LE(short_minutes, 0.5 * full_minutes);
  EXPECT_LT(tracked_square.mean(), 1.1 * 1.1 * full_square.mean());
  EXPECT_LT(tracked_square.mean(), stale_square.mean());
  EXPECT_LE(refused, 2 + static_cast<int>(0.005 * 3 * kDays * coverage.count));
  return coverage;
}

// The checks of one machine depend on each other: the scatter from machine to machine counts.
double BandOf(const Mean& coverage) { return coverage.count > 2.0 ? k99 * coverage.error() : 0.05; }

TEST(TrackedMap, IsAsUncertainAsItSaysOnMachinesThatDrift) {
  const Mean coverage = RunMonths("0.5");
  EXPECT_NEAR(coverage.mean(), 0.95, 0.01 + BandOf(coverage));
}

TEST(TrackedMap, KeepsTheFormOfItsTargetInItsUncertainty) {
  const Mean coverage = RunMonths("10.0");
  EXPECT_NEAR(coverage.mean(), 0.95, 0.01 + BandOf(coverage));
}

TEST(TrackedMap, IsNoStepBackWhereNothingDrifts) {
  const settings::Document document = Machine(kStill);
  const machine::Drift drift = machine::ReadDrift(document.Root());
  const Seeds seeds = SeedsFromEnvironment();
  Mean tracked_square, first_square;
  int refused = 0;
  for (std::uint64_t seed = seeds.first; seed <= seeds.last; seed += seeds.step) {
    OldMachine mill(document, seed);
    mill.GoTo(0.0);
    const map::ErrorMap first = mill.Fused(mill.FullSet(1)).map;
    TrackedMap tracked(mill.campaign.machine, first, drift);
    for (int day = 1; day <= 6; ++day) {
      tracked.Follow({.time = mill.TimeAt(day)});
      for (const Recording& each : mill.ShortTest(day, static_cast<std::uint64_t>(100 + day))) {
        try {
          tracked.Take(mill.Runs({each}, first.model()), mill.TimeAt(day));
        } catch (const InputError&) {
          ++refused;  // p below 1e-3 happens by chance
        }
      }
    }
    tracked_square.Add(SquareOff(tracked.Map(), mill, seed));
    first_square.Add(SquareOff(first, mill, seed));
  }
  fmt::print("rms um: the first map {:.3f}, after six short tests {:.3f}\n", Root(first_square),
             Root(tracked_square));
  EXPECT_LT(tracked_square.mean(), first_square.mean());
  EXPECT_LE(refused, 1 + static_cast<int>(0.005 * 18 * first_square.count));
}

TEST(TrackedMap, LearnsTheWalkFromItsTests) {
  // The rig walks three times as far as the machine file says; without warmth.
  std::string text = kDrifts;
  text = text.substr(0, text.find("[drift.temperature"));
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"positioning_um = 0.1", "positioning_um = 0.03"},
           {"straightness_um = 0.05", "straightness_um = 0.017"},
           {"roll_urad = 1.0", "roll_urad = 0.33"},
           {"pitch_urad = 1.0", "pitch_urad = 0.33"},
           {"yaw_urad = 1.0", "yaw_urad = 0.33"},
           {"squareness_urad = 1.5", "squareness_urad = 0.5"},
           {"scale_ppm = 1.0", "scale_ppm = 0.33"}}) {
    text.replace(text.find(from), from.size(), to);
  }
  text +=
      "[rig.ageing]\npositioning_um = 0.1\nstraightness_um = 0.05\nroll_urad = 1.0\n"
      "pitch_urad = 1.0\nyaw_urad = 1.0\nsquareness_urad = 1.5\nscale_ppm = 1.0\n";
  const settings::Document document = Machine(text);
  OldMachine mill(document, 4);
  mill.GoTo(0.0);
  const map::ErrorMap first = mill.Fused(mill.FullSet(1)).map;
  TrackedMap start(mill.campaign.machine, first, machine::ReadDrift(document.Root()));
  std::vector<HistoryStep> history;
  for (int day = 2; day <= 12; day += 2) {
    mill.GoTo(day);
    for (const Recording& each : mill.ShortTest(day / 2, static_cast<std::uint64_t>(100 + day))) {
      history.push_back(
          {{{.time = mill.TimeAt(day)}}, mill.Runs({each}, first.model()), mill.TimeAt(day)});
    }
  }
  const Learned learned = Learn(start, history, {});
  fmt::print("factor {:.2f} of 3, log likelihood + {:.1f}\n", learned.factor, learned.gain);
  EXPECT_GT(learned.factor, 2.0);
  EXPECT_LT(learned.factor, 4.5);
}

}  // namespace tracked_map_test
}  // namespace abbe::track
