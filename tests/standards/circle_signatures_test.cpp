#include "standards/circle_signatures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace abbe::standards {
namespace circle_signatures_test {

constexpr double kPi = std::numbers::pi;
constexpr double kRadius = 0.05, kFeed = 0.02;

const Signature& Find(const std::vector<Signature>& table, const std::string& cause,
                      const std::string& object) {
  for (const Signature& signature : table) {
    if (signature.cause == cause && signature.object == object) return signature;
  }
  throw std::out_of_range(cause + " " + object);
}

// The machine that a cause describes: commanded position and velocity to where the tool goes.
struct Moving {
  double x, y, vx, vy;
};
using Machine = std::pair<double, double> (*)(const Moving& at, double amount);

struct Case {
  const char* cause;
  const char* object;
  double amount;
  Machine machine;
};

double Sign(double value) { return value > 0 ? 1 : -1; }

// Exact displacements of the position, so that nothing of the table is repeated here.
const Case kCases[] = {
    {"scale", "X", 1e-5,
     [](const Moving& m, double s) {
       return std::pair{m.x * (1 + s), m.y};
     }},
    {"scale", "Y", 1e-5,
     [](const Moving& m, double s) {
       return std::pair{m.x, m.y * (1 + s)};
     }},
    {"squareness", "XY", 1e-5,
     [](const Moving& m, double c) {
       return std::pair{m.x - m.y * std::sin(c), m.y * std::cos(c)};
     }},
    {"servo_mismatch", "XY", 1e-5,  // X is late by the mismatch, Y by none
     [](const Moving& m, double dt) {
       return std::pair{m.x - m.vx * dt, m.y};
     }},
    {"backlash", "X", 1e-6,
     [](const Moving& m, double b) {
       return std::pair{m.x - b / 2 * Sign(m.vx), m.y};
     }},
    {"backlash", "Y", 1e-6,
     [](const Moving& m, double b) {
       return std::pair{m.x, m.y - b / 2 * Sign(m.vy)};
     }},
    {"straightness", "EYX", 1e-6,
     [](const Moving& m, double h) {
       return std::pair{m.x, m.y + h * m.x * m.x / (kRadius * kRadius)};
     }},
    {"straightness", "EXY", 1e-6,
     [](const Moving& m, double h) {
       return std::pair{m.x + h * m.y * m.y / (kRadius * kRadius), m.y};
     }},
    {"cyclic_sin", "X", 1e-6,
     [](const Moving& m, double a) {
       return std::pair{m.x + a * std::sin(2 * kPi * (0.1 + m.x) / 0.005), m.y};
     }},
    {"cyclic_cos", "Y", 1e-6,
     [](const Moving& m, double a) {
       return std::pair{m.x, m.y + a * std::cos(2 * kPi * (0.2 + m.y) / 0.004)};
     }},
    {"centre", "Y", 1e-6,
     [](const Moving& m, double c) {
       return std::pair{m.x, m.y + c};
     }},
};

TEST(CircleSignatures, AreWhatEachMachineDoesToTheRadius) {
  const auto table = CircleSignatures(
      {.first_centre = 0.1, .second_centre = 0.2, .pitch = {{'X', 0.005}, {'Y', 0.004}}});
  for (const Case& one : kCases) {
    const Signature& signature = Find(table, one.cause, one.object);
    for (const double sense : {1.0, -1.0}) {
      for (int degree = 3; degree < 360; degree += 7) {
        const double t = degree * kPi / 180;
        const double w = sense * kFeed / kRadius;
        const Moving at{kRadius * std::cos(t), kRadius * std::sin(t), -kRadius * w * std::sin(t),
                        kRadius * w * std::cos(t)};
        const auto [x, y] = one.machine(at, one.amount);
        const double error = std::hypot(x - at.x, y - at.y);
        const double radial =
            one.amount *
            signature.radial({.angle = t, .sense = sense, .radius = kRadius, .feed = kFeed});
        // What is neglected: the displacement squared over the diameter, and the squared angle.
        const double second_order = error * error / kRadius + 1e-10 * kRadius;
        EXPECT_NEAR(radial, std::hypot(x, y) - kRadius, second_order)
            << one.cause << ' ' << one.object << " at " << degree;
      }
    }
  }
}

// A first-order lag T on both axes: the amplitude falls by 1 / sqrt(1 + (w T)^2).
TEST(CircleSignatures, CommonLagShrinksTheCircle) {
  const auto table = CircleSignatures({});
  constexpr double T = 1e-3;
  const double w = kFeed / kRadius;
  const double shrunk = kRadius / std::sqrt(1 + w * w * T * T) - kRadius;
  const double radial = T * T *
                        Find(table, "servo_lag_squared", "XY")
                            .radial({.angle = 1, .sense = 1, .radius = kRadius, .feed = kFeed});
  EXPECT_NEAR(radial, shrunk, kRadius * std::pow(w * T, 4));
}

// After a quadrant is passed the axis that turned sticks: outwards, largest one width on.
TEST(CircleSignatures, SpikesStandBehindTheReversal) {
  const auto table = CircleSignatures({.pitch = {}, .spike = {.width = {0.05, 0.05}}});
  for (const auto& [axis, extremes] :
       {std::pair{"X", std::pair{0.0, kPi}}, std::pair{"Y", std::pair{kPi / 2, -kPi / 2}}}) {
    const auto& radial = Find(table, "reversal_spike", axis).radial;
    for (const double extreme : {extremes.first, extremes.second}) {
      for (const double sense : {1.0, -1.0}) {
        const auto at = [&](double since) {
          return radial({.angle = extreme + sense * since, .sense = sense, .radius = 1, .feed = 1});
        };
        EXPECT_NEAR(at(0.05), 1.0, 1e-12);
        EXPECT_LT(at(0.02), 1.0);
        EXPECT_LT(at(0.1), 1.0);
        EXPECT_LT(at(-0.01), 1e-20);  // before: the tail of the last one, half a turn ago
      }
    }
  }
}

// A bow of Y along itself is, with the other sign, one of X into Y beside another centre.
TEST(CircleSignatures, SayWhichBowsARadiusDoesNotTellApart) {
  const Signature bow = Find(CircleSignatures({}), "straightness", "EYX");
  EXPECT_EQ(bow.alike, "-EYY");
  constexpr double h = 1e-6;
  for (int degree = 0; degree < 360; degree += 7) {
    const double t = degree * kPi / 180, x = kRadius * std::cos(t), y = kRadius * std::sin(t);
    const double along = std::hypot(x, y - h * std::pow(y / kRadius, 2)) - kRadius;
    const double into = h * bow.radial({.angle = t, .sense = 1, .radius = kRadius, .feed = kFeed});
    EXPECT_NEAR(into - along, h * std::sin(t), 1e-10) << degree;
  }
}

// The trap: backlash of one axis alone projects on d sin 2t with 4 / (3 pi) = 0.424 of its size.
TEST(CircleSignatures, UnequalBacklashLooksLikeServoMismatch) {
  const auto table = CircleSignatures({});
  double projection = 0;
  constexpr int n = 3600;
  for (int i = 0; i < n; ++i) {
    const double t = 2 * kPi * (i + 0.5) / n;
    projection +=
        2.0 / n * std::sin(2 * t) *
        Find(table, "backlash", "X").radial({.angle = t, .sense = 1, .radius = 1, .feed = 1});
  }
  EXPECT_NEAR(projection, 4 / (3 * kPi), 1e-5);  // midpoint rule with steps: O(1 / n^2)
}

}  // namespace circle_signatures_test
}  // namespace abbe::standards
