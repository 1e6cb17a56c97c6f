#include "fusion/circle_causes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "failure/failure.h"
#include "random/counter_random.h"
#include "tests/seeds.h"

namespace abbe::fusion {
namespace circle_causes_test {

constexpr double kPi = std::numbers::pi;
constexpr double kRadius = 0.01;

struct Machine {
  double scale_x = 0, scale_y = 0, squareness = 0;
  double delay_x = 0, delay_y = 0, lag = 0;  // s
  double backlash_x = 0, backlash_y = 0;
  double play_x = 0;                // backlash that is taken up on the way
  double wind_up_x = 0;             // backlash that is taken up gradually,
  double wind_up_way = 10e-6;       // m: to a part of 1/e
  double stuck_x = 0;               // m: outwards, where it turns,
  double stuck_for = 0;             // rad, or
  double stuck_time = 0;            // s: falls to a part of 1/e
  double bow_eyx = 0, bow_exy = 0;  // m at the radius
  double lobes = 0;                 // m: a fifth harmonic that turns with the sense
  double offset_x = 0, offset_y = 0;
  double noise = 0;
  double wander = 0;  // m: of each axis, remembered for 20 degrees
};

double Sign(double value) { return value > 0 ? 1 : value < 0 ? -1 : 0; }

// Where a carriage is that the drive takes along with play: on the way after a reversal it stands.
double AfterPlay(double drive, double velocity, double amplitude, double play) {
  const double behind = drive - Sign(velocity) * play / 2;
  const double turned = -Sign(velocity) * (amplitude - play / 2);  // where it stood
  return velocity > 0 ? std::max(behind, turned) : std::min(behind, turned);
}

// What a carriage that winds up stays behind: half of `lost` long after a reversal, and as much on the
// other side just after it.
double WindUp(double drive, double velocity, double amplitude, double lost, double way) {
  const double gone = amplitude + Sign(velocity) * drive;
  return -Sign(velocity) * lost * (0.5 - std::exp(-gone / way));
}

// What an axis that sticks where it turns stays outside, the angle `since` it turned; `end` of 1 or -1.
double Stuck(const Machine& m, double since, double end, double w) {
  if (m.stuck_x == 0.0) return 0.0;
  return end * m.stuck_x *
         std::exp(-since / (m.stuck_time > 0.0 ? std::abs(w) * m.stuck_time : m.stuck_for));
}

// Where the tool goes: position errors, one after the other; nothing of the table of signatures.
paths::CircleRun Measure(const Machine& m, double feed, const std::vector<int>& senses,
                         std::uint64_t seed = 1, int points = 720) {
  paths::CircleRun run;
  run.recordings = {"made"};
  run.instrument = "reference";
  run.plane = {"XY", Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()};
  run.radius = kRadius;
  run.centre = Eigen::Vector3d(0.03, 0.03, 0.02);
  run.feed = feed;
  const random::CounterRandom noise(seed, static_cast<std::uint64_t>(feed * 1e6));
  std::uint64_t draw = 0;
  const random::CounterRandom wander(seed, static_cast<std::uint64_t>(feed * 1e6) + 1);
  const double kept = std::exp(-360.0 / points / 20.0);
  std::uint64_t step = 0;
  double far_x = wander.Normal(step++), far_y = wander.Normal(step++);
  for (const int sense : senses) {
    const double w = sense * feed / kRadius;
    const double amplitude = kRadius / std::sqrt(1 + w * w * m.lag * m.lag);
    for (int i = 0; i < points; ++i) {
      const double t = 2 * kPi * (i + 0.5) / points;
      const double cx = amplitude * std::cos(t - w * m.delay_x);
      const double cy = amplitude * std::sin(t - w * m.delay_y);
      const double vx = -w * std::sin(t), vy = w * std::cos(t);
      double x = cx * (1 + m.scale_x) - m.backlash_x / 2 * Sign(vx);
      double y = cy * (1 + m.scale_y) - m.backlash_y / 2 * Sign(vy);
      x += AfterPlay(cx, vx, amplitude, m.play_x) - cx;
      x += WindUp(cx, vx, amplitude, m.wind_up_x, m.wind_up_way);
      const double turned = sense > 0 ? t : 2 * kPi - t;  // of X, from its positive end
      x += Stuck(m, std::fmod(turned, kPi), turned < kPi ? 1.0 : -1.0, w);
      y += m.bow_eyx * cx * cx / (kRadius * kRadius);
      x += m.bow_exy * cy * cy / (kRadius * kRadius);
      x -= y * std::sin(m.squareness);
      x += sense * m.lobes * std::cos(5 * t) * std::cos(t);
      y += sense * m.lobes * std::cos(5 * t) * std::sin(t);
      x += m.offset_x + m.noise * noise.Normal(draw++);
      y += m.offset_y + m.noise * noise.Normal(draw++);
      far_x = kept * far_x + std::sqrt(1 - kept * kept) * wander.Normal(step++);
      far_y = kept * far_y + std::sqrt(1 - kept * kept) * wander.Normal(step++);
      x += m.wander * far_x;
      y += m.wander * far_y;
      run.points.push_back({x, y, 0, t, sense, 1});
    }
  }
  return run;
}

const CauseEstimate& Find(const CircleCauses& causes, const std::string& cause,
                          const std::string& object) {
  for (const CauseEstimate& one : causes.causes) {
    if (one.cause == cause && one.object == object) return one;
  }
  throw std::out_of_range(cause + " " + object);
}

struct Truth {
  const char* cause;
  const char* object;
  double value;
};

std::vector<Truth> TruthOf(const Machine& m) {
  return {{"scale", "X", m.scale_x},
          {"scale", "Y", m.scale_y},
          {"squareness", "XY", m.squareness},
          {"servo_mismatch", "XY", m.delay_x - m.delay_y},
          {"servo_lag_squared", "XY", m.lag * m.lag},
          {"backlash", "X", m.backlash_x},
          {"backlash", "Y", m.backlash_y},
          {"straightness", "EYX", m.bow_eyx},
          {"straightness", "EXY", m.bow_exy},
          {"reversal_spike", "X", 0.0},
          {"reversal_spike", "Y", 0.0}};
}

const Machine kAll{.scale_x = 60e-6,
                   .scale_y = -40e-6,
                   .squareness = 80e-6,
                   .delay_x = 0.4e-3,
                   .delay_y = 0.1e-3,
                   .lag = 4e-3,
                   .backlash_x = 3e-6,
                   .backlash_y = 1e-6,
                   .bow_eyx = 2e-6,
                   .bow_exy = -1e-6,
                   .lobes = 0,
                   .offset_x = 20e-6,
                   .offset_y = -10e-6,
                   .noise = 0};

// Backlash is taken up with play or by wind-up. As a step at once 4 um came out as 3 um, with
// reversal spikes and servo mismatch that are not there.
TEST(CircleCauses, BacklashIsTakenUpOnTheWay) {
  Machine with_play, by_wind_up;
  with_play.play_x = by_wind_up.wind_up_x = 4e-6;
  for (Machine m : {with_play, by_wind_up}) {
    m.noise = 0.1e-6;
    const auto run = Measure(m, 0.01, {1, -1});
    const CircleCauses found = FitCircleCauses({&run}, {});
    for (const CauseEstimate& one : found.causes) {
      const double truth = one.cause == "backlash" && one.object == "X" ? 4e-6 : 0.0;
      if (!one.seen) continue;
      EXPECT_NEAR(one.value, truth, 3.0 * one.u) << one.cause << ' ' << one.object;
    }
    EXPECT_LT(Find(found, "backlash", "X").u, 0.06e-6);
  }
}

// Over ways between those of any list, at a radius that the largest ways are half of.
TEST(CircleCauses, BacklashThatWindsUpOverMillimetresIsAsSureAsItsWay) {
  double inside = 0.0, all = 0.0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const random::CounterRandom random(seed, 0xBAC);
    Machine m{.scale_x = 20e-6 * random.Normal(0), .scale_y = 20e-6 * random.Normal(1)};
    m.wind_up_x = 4e-6 * (1.0 + random.Uniform(2));
    m.wind_up_way = 0.3e-3 * std::pow(4e-3 / 0.3e-3, random.Uniform(3));
    m.noise = 0.1e-6;
    const auto slow = Measure(m, 0.002, {1, -1}, seed), fast = Measure(m, 0.02, {1, -1}, seed);
    const CircleCauses found = FitCircleCauses({&slow, &fast});
    for (Truth truth : TruthOf(m)) {
      if (std::string(truth.cause) == "backlash" && truth.object[0] == 'X') {
        truth.value = m.wind_up_x;
      }
      const CauseEstimate& one = Find(found, truth.cause, truth.object);
      inside += std::abs(one.value - truth.value) < 2.0 * one.u ? 1.0 : 0.0;
      all += 1.0;
    }
  }
  EXPECT_GT(inside / all, 0.93);
}

// Friction that falls from the reversal on, over 1.5 to 7.5 degrees, as long on the circle at both
// feeds or as long in time.
TEST(CircleCauses, FrictionThatFallsFromTheReversalOnIsNoBacklash) {
  double inside = 0.0, all = 0.0;
  std::string off;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const random::CounterRandom random(seed, 0x57C);
    Machine m{.squareness = 20e-6 * random.Normal(0), .delay_x = 0.3e-3 * random.Normal(1)};
    m.stuck_x = 2e-6 + 4e-6 * random.Uniform(2);
    m.stuck_for = 0.026 + 0.105 * random.Uniform(3);
    if (seed % 2 == 0) m.stuck_time = m.stuck_for * kRadius / 0.006;  // as wide at 6 mm/s
    m.backlash_x = seed % 3 == 0 ? 0.0 : 3e-6 * random.Normal(4);
    m.noise = 0.1e-6;
    const auto slow = Measure(m, 0.002, {1, -1}, seed, 360);
    const auto fast = Measure(m, 0.02, {1, -1}, seed, 360);
    const CircleCauses found = FitCircleCauses({&slow, &fast});
    for (Truth truth : TruthOf(m)) {
      if (std::string(truth.cause) == "reversal_spike" && truth.object[0] == 'X') {
        truth.value = m.stuck_x;
      }
      const CauseEstimate& one = Find(found, truth.cause, truth.object);
      const double times = (one.value - truth.value) / one.u;
      if (std::abs(times) < 2.0) {
        inside += 1.0;
      } else {
        off += fmt::format("{}: {} {} {:.1f} u\n", seed, one.cause, one.object, times);
      }
      all += 1.0;
    }
    EXPECT_LT(Find(found, "backlash", "X").u, 0.5e-6) << seed;
  }
  EXPECT_GT(inside / all, 0.9) << off;
}

TEST(CircleCauses, AllCausesAtOnceAreToldApart) {
  const auto slow = Measure(kAll, 0.002, {1, -1}), fast = Measure(kAll, 0.03, {1, -1});
  const CircleCauses found = FitCircleCauses({&slow, &fast});
  // Neglected: squares of the errors beside the radius (20 um, 10 mm: 40 nm), products such as
  // bow and angle (0.3 ms at 30 mm/s turns by 1 mrad: 3 nm on bow and backlash).
  for (const Truth& truth : TruthOf(kAll)) {
    const CauseEstimate& one = Find(found, truth.cause, truth.object);
    const double effect_per_unit = one.effect / std::abs(one.value);
    EXPECT_NEAR(one.value * effect_per_unit, truth.value * effect_per_unit, 60e-9)
        << truth.cause << ' ' << truth.object;
  }
  EXPECT_LT(found.rms_after, 60e-9);
  EXPECT_GT(found.rms_before, 1e-6);
}

// Ten micrometres of backlash on one axis: a harmonic by harmonic reading sees 4.2 um of servo
// mismatch (4 / (3 pi) of it), the joint fit none.
TEST(CircleCauses, BacklashIsNotTakenForServoMismatch) {
  Machine m;
  m.backlash_x = 10e-6;
  const auto slow = Measure(m, 0.002, {1, -1}), fast = Measure(m, 0.01, {1, -1});
  const CircleCauses found = FitCircleCauses({&slow, &fast});
  EXPECT_NEAR(Find(found, "backlash", "X").value, 10e-6, 20e-9);
  EXPECT_LT(Find(found, "servo_mismatch", "XY").effect, 50e-9);
  EXPECT_LT(Find(found, "squareness", "XY").effect, 20e-9);
}

TEST(CircleCauses, OneSenseCannotTellSquarenessFromMismatch) {
  Machine m;
  m.squareness = 100e-6;
  m.noise = 0.1e-6;
  const auto one = Measure(m, 0.002, {1});
  const CircleCauses found = FitCircleCauses({&one});
  EXPECT_FALSE(Find(found, "servo_mismatch", "XY").seen);
  bool named = false;
  for (const std::string& words : found.weak_directions) {
    named = named || (words.find("servo_mismatch") != std::string::npos);
  }
  EXPECT_TRUE(named);
  // Honest: the truth lies within what the uncertainty allows.
  const CauseEstimate& square = Find(found, "squareness", "XY");
  EXPECT_LT(std::abs(square.value - 100e-6), 3 * square.u);
  EXPECT_GT(square.u, 50e-6);
}

TEST(CircleCauses, OneFeedCannotTellLagFromScale) {
  Machine m;
  m.scale_x = m.scale_y = -50e-6;
  m.noise = 0.1e-6;
  const auto one = Measure(m, 0.03, {1, -1});
  EXPECT_GT(Find(FitCircleCauses({&one}), "servo_lag_squared", "XY").u, 5e-6);
  const auto slow = Measure(m, 0.005, {1, -1});
  EXPECT_LT(Find(FitCircleCauses({&one, &slow}), "servo_lag_squared", "XY").u, 1e-6);
}

// Pulls over 200 machines measured: mean 0, variance 1, each within its 99.9 % band.
TEST(CircleCauses, UncertaintiesAreTrue) {
  constexpr int kPoints = 240;
  const auto count = static_cast<int>(SeedsFromEnvironment().last);
  Machine m = kAll;
  m.noise = 0.5e-6;
  m.offset_x = m.offset_y = 0;
  std::vector<double> sums(TruthOf(m).size()), squares(sums.size());
  for (int seed = 0; seed < count; ++seed) {
    const auto slow = Measure(m, 0.002, {1, -1}, 10 + seed, kPoints),
               fast = Measure(m, 0.01, {1, -1}, 500 + seed, kPoints);
    const CircleCauses found = FitCircleCauses({&slow, &fast});
    for (std::size_t i = 0; i < sums.size(); ++i) {
      const Truth truth = TruthOf(m)[i];
      const CauseEstimate& one = Find(found, truth.cause, truth.object);
      const double pull = (one.value - truth.value) / one.u;
      sums[i] += pull;
      squares[i] += pull * pull;
    }
  }
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const double mean = sums[i] / count;
    const double variance = squares[i] / count - mean * mean;
    const char* name = TruthOf(m)[i].cause;
    EXPECT_LT(std::abs(mean), 3.3 / std::sqrt(count)) << name;
    // The noise is estimated with the factor for shared scatter, which is held at 1 and more: it
    // errs by up to 1 / sqrt(2 * 144 sectors) = 6 % upwards, half of the time.
    EXPECT_GT(variance, (1 - 3.3 * std::sqrt(2.0 / count)) / 1.06) << name;
    EXPECT_LT(variance, 1 + 3.3 * std::sqrt(2.0 / count)) << name;
  }
}

// An instrument that wanders, in both runs or in one beside another that is noisy: noise that is
// remembered over more of the circle than neighbours share.
TEST(CircleCauses, UncertaintiesAreTrueWhereNoiseIsRemembered) {
  const auto count = static_cast<int>(SeedsFromEnvironment().last) / 6;
  Machine m = kAll;
  m.noise = 0.05e-6;
  m.wander = 0.3e-6;
  m.offset_x = m.offset_y = 0;
  Machine noisy = m;
  noisy.noise = 0.5e-6;
  noisy.wander = 0.0;
  double inside = 0.0, all = 0.0;
  for (int seed = 0; seed < count; ++seed) {
    const auto slow = Measure(m, 0.002, {1, -1}, 10 + seed, 360),
               fast = Measure(seed % 2 == 0 ? m : noisy, 0.01, {1, -1}, 500 + seed, 360);
    const CircleCauses found = FitCircleCauses({&slow, &fast});
    for (const Truth& truth : TruthOf(m)) {
      const CauseEstimate& one = Find(found, truth.cause, truth.object);
      inside += std::abs(one.value - truth.value) < 2 * one.u ? 1.0 : 0.0;
      all += 1.0;
    }
    EXPECT_LT(Find(found, "backlash", "X").u, 0.3e-6);
  }
  EXPECT_GT(inside / all, 0.95 - 3.3 * std::sqrt(0.95 * 0.05 / all)) << inside << " of " << all;
}

// What no cause explains and no smooth error of the machine does makes the uncertainties larger,
// not the causes.
TEST(CircleCauses, UnexplainedLobesWidenTheUncertainty) {
  Machine m;
  m.noise = 0.2e-6;
  const auto plain = Measure(m, 0.002, {1, -1});
  m.lobes = 1e-6;
  const auto lobed = Measure(m, 0.002, {1, -1});
  const CircleCauses quiet = FitCircleCauses({&plain}), loud = FitCircleCauses({&lobed});
  EXPECT_FALSE(loud.TableHolds());
  EXPECT_NEAR(quiet.beyond_noise, 1.0, 0.1);
  for (const CauseEstimate& one : loud.causes) EXPECT_FALSE(loud.IsCertain(one)) << one.cause;
  EXPECT_GT(Find(loud, "backlash", "X").u, 3 * Find(quiet, "backlash", "X").u);
  EXPECT_LT(std::abs(Find(loud, "backlash", "X").value), 3 * Find(loud, "backlash", "X").u);
}

// A machine whose errors are smooth has harmonics of every order, the same in both senses: they are
// no spikes and no backlash, and do not make the uncertainties larger.
TEST(CircleCauses, SmoothErrorsAreNoSpikes) {
  Machine m;
  m.noise = 0.1e-6;
  const auto plain = Measure(m, 0.002, {1, -1});
  paths::CircleRun smooth = plain;
  for (auto& point : smooth.points) {
    const double wave = 2e-6 * std::cos(4 * point.angle + 0.3) + 1e-6 * std::sin(7 * point.angle);
    point.first += wave * std::cos(point.angle);
    point.second += wave * std::sin(point.angle);
  }
  const CircleCauses without = FitCircleCauses({&plain}), with = FitCircleCauses({&smooth});
  for (const char* cause : {"backlash", "reversal_spike"}) {
    for (const char* axis : {"X", "Y"}) {
      const CauseEstimate& one = Find(with, cause, axis);
      // Nothing of what there is without the waves changes but their square beside the radius.
      EXPECT_NEAR(one.value, Find(without, cause, axis).value, 1e-9) << cause << axis;
      EXPECT_NEAR(one.u / Find(without, cause, axis).u, 1.0, 0.01) << cause << axis;
    }
  }
  EXPECT_NEAR(with.rms_smooth, std::sqrt((4.0 + 1.0) / 2.0) * 1e-6, 0.02e-6);
  // Without these terms they pass for noise that is remembered.
  CauseOptions without_terms;
  without_terms.smooth.clear();
  const CircleCauses naive = FitCircleCauses({&smooth}, without_terms);
  const CauseEstimate& spike = Find(naive, "reversal_spike", "X");
  EXPECT_LT(std::abs(spike.value), 2 * spike.u);
  EXPECT_GT(spike.u, 5 * Find(with, "reversal_spike", "X").u);
}

// An instrument that may be out of square by 10 urad: that much, and no less, is not known of the
// machine's squareness.
TEST(CircleCauses, TheInstrumentsUncertaintyIsInThoseOfTheCauses) {
  Machine m;
  m.noise = 0.01e-6;
  const auto seen = Measure(m, 0.002, {1, -1});
  paths::CircleRun shifted = seen;
  for (auto& point : shifted.points) point.first -= 10e-6 * point.second;
  CauseOptions options;
  options.shifted = {{&shifted}};
  const CircleCauses found = FitCircleCauses({&seen}, options);
  EXPECT_NEAR(Find(found, "squareness", "XY").u, 10e-6, 0.1e-6);
  // Nothing of it is in the other causes.
  const double alone = Find(FitCircleCauses({&seen}), "backlash", "X").u;
  EXPECT_NEAR(Find(found, "backlash", "X").u, alone, 0.05 * alone);
  for (const std::string& words : found.weak_directions) {
    EXPECT_EQ(words.find("instrument"), std::string::npos) << words;
  }
}

TEST(CircleCauses, CyclicErrorsAtAKnownPitch) {
  paths::CircleRun run = Measure({}, 0.002, {1, -1});
  for (auto& point : run.points) {
    const double x = 0.03 + kRadius * std::cos(point.angle);
    point.first += 0.5e-6 * std::sin(2 * kPi * x / 0.002);
  }
  CauseOptions options;
  options.pitch = {{'X', 0.002}, {'Y', 0.002}};
  const CircleCauses found = FitCircleCauses({&run}, options);
  EXPECT_NEAR(Find(found, "cyclic_sin", "X").value, 0.5e-6, 2e-9);
  EXPECT_NEAR(Find(found, "cyclic_cos", "X").value, 0.0, 2e-9);
  EXPECT_NEAR(Find(found, "cyclic_sin", "Y").value, 0.0, 2e-9);
}

TEST(CircleCauses, RefusesCirclesThatAreNotOne) {
  const auto one = Measure({}, 0.002, {1});
  auto other = one;
  other.radius = 0.02;
  EXPECT_THROW(FitCircleCauses(std::vector<const paths::CircleRun*>{}), InputError);
  EXPECT_THROW(FitCircleCauses({&one, &other}), InputError);
  other = one;
  other.plane.name = "inclined";
  EXPECT_THROW(FitCircleCauses({&other}), InputError);
}

}  // namespace circle_causes_test
}  // namespace abbe::fusion
