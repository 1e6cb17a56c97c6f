// The core of LinuxCNC's component against closed forms: a field that is linear in each coordinate,
// which interpolation repeats, turned by turns that are so too; ramps; refusals.
#include "control/linuxcnc/abbe_grid.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

namespace abbe::control {
namespace abbe_grid_test {

using Place = std::array<double, 3>;

constexpr Place kFirst = {-100.0, 20.0, -300.0}, kLast = {300.0, 220.0, 0.0};
constexpr std::array<int, 3> kCount = {5, 3, 4};
constexpr Place kSense = {1.0, -1.0, 1.0}, kTool = {2.0, -3.0, -80.0};

// um and urad: linear in each coordinate, with a term of all three.
double Value(int k, const Place& p) {
  const double x = p[0] / 100, y = p[1] / 100, z = p[2] / 100;
  return (k + 1) * (2.0 + 0.5 * x - 0.75 * y + 0.25 * z) + k * x * y - x * z + 0.125 * x * y * z;
}

std::string Line(int axis) {
  char line[100];
  std::snprintf(line, sizeof(line), "%c_mm %.3f %.3f %d %.3f %.3f\n", "xyz"[axis], kFirst[axis],
                kLast[axis], kCount[axis], kFirst[axis] - 1, kLast[axis] + 2);
  return line;
}

std::string Head() {
  return "abbe-map-grid 1\nsense 1 -1 1\ntool_mm 2 -3 -80\n" + Line(0) + Line(1) + Line(2);
}

Place PointAt(int x, int y, int z) {
  const std::array<int, 3> i = {x, y, z};
  Place p;
  for (int k = 0; k < 3; ++k) p[k] = kFirst[k] + (kLast[k] - kFirst[k]) * i[k] / (kCount[k] - 1);
  return p;
}

std::string Points() {
  std::string text = "# a comment\n";
  for (int z = 0; z < kCount[2]; ++z) {
    for (int y = 0; y < kCount[1]; ++y) {
      for (int x = 0; x < kCount[0]; ++x) {
        for (int k = 0; k < ABBE_GRID_VALUES; ++k) {
          char word[40];
          std::snprintf(word, sizeof(word), "%.12f ", Value(k, PointAt(x, y, z)));
          text += word;
        }
        text += "\n";
      }
    }
  }
  return text;
}

class AbbeGrid : public testing::Test {
 protected:
  AbbeGrid() {
    const auto* const test = testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::temp_directory_path() /
            ("abbe-grid-" + std::string(test->name()) + std::to_string(getpid()));
  }
  ~AbbeGrid() override {
    abbe_grid_free(&grid_);
    std::filesystem::remove(path_);
  }

  // The reason, or nothing.
  std::string Read(const std::string& text) {
    std::ofstream(path_) << text;
    abbe_grid_free(&grid_);
    char reason[ABBE_GRID_REASON];
    if (abbe_grid_read(path_.c_str(), &grid_, reason) == 1) return {};
    EXPECT_EQ(grid_.values, nullptr);
    return reason;
  }

  // By the closed form.
  static Place OffsetAt(const Place& command, const Place& tool_offset) {
    Place d, r, Q, offset;
    for (int k = 0; k < 3; ++k) {
      d[k] = 1e-3 * Value(k, command);
      r[k] = 1e-6 * Value(k + 3, command);
      Q[k] = kTool[k] - kSense[k] * tool_offset[k];
    }
    offset[0] = -kSense[0] * (d[0] + r[1] * Q[2] - r[2] * Q[1]);
    offset[1] = -kSense[1] * (d[1] + r[2] * Q[0] - r[0] * Q[2]);
    offset[2] = -kSense[2] * (d[2] + r[0] * Q[1] - r[1] * Q[0]);
    return offset;
  }

  static abbe_period Period(const Place& p, double step = 1e9, const Place& tool = {0, 0, 0}) {
    return {{p[0], p[1], p[2]}, {tool[0], tool[1], tool[2]}, {}, step, 1, 1, 1};
  }

  std::filesystem::path path_;
  abbe_grid grid_ = {};
};

// Rounding of 1e-12 um in the file, of 300 mm in double numbers; the next step of the correction
// would change it by its slope, 1e-4 of it, squared.
TEST_F(AbbeGrid, PutsTheToolWhereAFieldThatItRepeatsSaysForAnyTool) {
  ASSERT_EQ(Read(Head() + Points() + "end\n"), "");
  double largest = 0.0;
  for (const Place& tool : {Place{0, 0, 0}, Place{5, -20, 150}}) {
    for (int i = 0; i <= 20; ++i) {
      Place p;
      for (int k = 0; k < 3; ++k) {
        const double part = std::fmod(0.31 * i * (k + 1), 1.0);
        p[k] = kFirst[k] + 0.5 + (kLast[k] - kFirst[k] - 1.0) * part;
      }
      abbe_offsets now = {};
      const abbe_period period = Period(p, 1e9, tool);
      for (int step = 0; step < 4; ++step) abbe_offsets_step(&grid_, &period, &now);
      EXPECT_EQ(now.is_outside + now.is_limited, 0);
      const Place command = {p[0] + now.offset[0], p[1] + now.offset[1], p[2] + now.offset[2]};
      const Place offset = OffsetAt(command, tool);
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(now.offset[k], offset[k], 1e-11);
        largest = std::max(largest, std::abs(now.offset[k]));
      }
    }
  }
  EXPECT_GT(largest, 0.01);
}

TEST_F(AbbeGrid, BeyondTheEndsTheErrorIsThatOfTheEndUpToTheLimit) {
  ASSERT_EQ(Read(Head() + Points() + "end\n"), "");
  double at[3] = {kLast[0] + 1.9, 100, -50}, end[3] = {kLast[0], 100, -50}, error[3], expected[3];
  ASSERT_EQ(abbe_grid_error(&grid_, at, grid_.tool, error), 1);
  ASSERT_EQ(abbe_grid_error(&grid_, end, grid_.tool, expected), 1);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(error[k], expected[k]);
  at[0] = kLast[0] + 2.1;
  EXPECT_EQ(abbe_grid_error(&grid_, at, grid_.tool, error), 0);
  at[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(abbe_grid_error(&grid_, at, grid_.tool, error), 0);
}

TEST_F(AbbeGrid, AnOffsetRampsUpIsHeldOutsideAndRampsDown) {
  ASSERT_EQ(Read(Head() + Points() + "end\n"), "");
  const Place p = {120, 77, -111};
  const double step = 1e-4;
  abbe_period period = Period(p, step);
  abbe_offsets now = {}, before = {};
  const auto advance = [&] {
    before = now;
    abbe_offsets_step(&grid_, &period, &now);
    for (int k = 0; k < 3; ++k) {
      EXPECT_LE(std::abs(now.offset[k] - before.offset[k]), step * (1 + 1e-9));
    }
  };
  advance();
  EXPECT_NEAR(std::abs(now.offset[0]), step, 1e-15);
  EXPECT_EQ(now.is_limited, 1);
  int periods = 1;
  for (; now.is_limited == 1 && periods < 10000; ++periods) advance();
  const Place reached = {now.offset[0], now.offset[1], now.offset[2]};
  const double largest =
      std::max({std::abs(reached[0]), std::abs(reached[1]), std::abs(reached[2])});
  EXPECT_NEAR(periods, largest / step, 2);
  EXPECT_GT(periods, 20);

  period.position[0] = kLast[0] + 50;
  advance();
  EXPECT_EQ(now.is_outside, 1);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(now.offset[k], reached[k], 1e-7);
  period.position[0] = std::numeric_limits<double>::infinity();
  advance();
  EXPECT_EQ(now.is_outside, 1);
  period.position[0] = -80;
  advance();
  EXPECT_EQ(now.is_outside, 0);
  EXPECT_EQ(now.is_limited, 1);

  period.enable = 0;
  for (int i = 0; i < 10000 && (i == 0 || now.is_limited == 1); ++i) advance();
  for (int k = 0; k < 3; ++k) EXPECT_EQ(now.offset[k], 0.0);
}

// LinuxCNC ignores what comes while it is not homed, and forgets the offsets when it is off.
TEST_F(AbbeGrid, NothingChangesUnhomedAndAllIsZeroWithoutTheMachine) {
  ASSERT_EQ(Read(Head() + Points() + "end\n"), "");
  abbe_period period = Period({120, 77, -111});
  abbe_offsets now = {};
  period.homed = 0;
  abbe_offsets_step(&grid_, &period, &now);
  for (const double offset : now.offset) EXPECT_EQ(offset, 0.0);
  period.homed = 1;
  abbe_offsets_step(&grid_, &period, &now);
  const double held = now.offset[1];
  EXPECT_GT(std::abs(held), 1e-3);
  period.homed = 0;
  period.position[1] = 200;
  period.enable = 0;
  abbe_offsets_step(&grid_, &period, &now);
  EXPECT_EQ(now.offset[1], held);
  period.machine_on = 0;
  abbe_offsets_step(&grid_, &period, &now);
  for (const double offset : now.offset) EXPECT_EQ(offset, 0.0);
}

// [AXIS_X] without OFFSET_AV_RATIO, a soft limit: the control says nothing of it.
TEST_F(AbbeGrid, AControlThatAppliesNothingIsMissedAfterAHundredPeriods) {
  ASSERT_EQ(Read(Head() + Points() + "end\n"), "");
  abbe_period period = Period({120, 77, -111}, 1e-4);
  abbe_offsets now = {};
  const auto advance = [&](int periods, bool follows) {
    for (int i = 0; i < periods; ++i) {
      for (int k = 0; follows && k < 3; ++k) period.applied[k] = now.offset[k];
      abbe_offsets_step(&grid_, &period, &now);
      if (follows) {
        EXPECT_EQ(now.is_missed, 0);
      }
    }
  };
  advance(1000, true);
  EXPECT_EQ(now.is_limited, 0);
  // More than 1 um and four steps.
  EXPECT_GT(std::max(std::abs(now.offset[1]), std::abs(now.offset[2])), 1.5e-3);
  for (double& applied : period.applied) applied = 0.0;
  advance(99, false);
  EXPECT_EQ(now.is_missed, 0);
  advance(1, false);
  EXPECT_EQ(now.is_missed, 1);
  period.applied[0] = std::numeric_limits<double>::quiet_NaN();
  advance(1, false);
  EXPECT_EQ(now.is_missed, 1);
  advance(1, true);
}

TEST_F(AbbeGrid, AToolThatMakesAnErrorOfMoreThanTenMillimetresIsRefused) {
  ASSERT_EQ(Read(Head() + Points() + "end\n"), "");
  abbe_offsets now = {};
  const abbe_period wild = Period({120, 77, -111}, 1e9, {0, 0, 1e7});
  abbe_offsets_step(&grid_, &wild, &now);
  EXPECT_EQ(now.is_outside, 1);
  for (const double offset : now.offset) EXPECT_EQ(offset, 0.0);
}

TEST_F(AbbeGrid, ADamagedFileIsRefusedWithItsLine) {
  const auto refused = [&](const std::string& text, const std::string& part) {
    const std::string reason = Read(text);
    EXPECT_NE(reason.find(part), std::string::npos) << "`" << reason << "` lacks `" << part << "`";
  };
  const std::string head = Head(), points = Points();
  refused("", ":0: not a grid");
  refused("abbe-map-grid 2\n", ":1: not a grid");
  refused("abbe-map-grid 1\nsense 1 0 1\n", ":2: not a grid");
  refused("abbe-map-grid 1\nsense 1 1 1\ntool_mm 0 0\n", ":3: not a grid");
  const std::string three = "abbe-map-grid 1\nsense 1 1 1\ntool_mm 0 0 nan\n";
  refused(three, ":3: not a grid");
  for (const char* const axis : {"x_mm 0 60 1 0 60", "x_mm 60 0 3 0 60", "x_mm 0 60 2.5 0 60",
                                 "x_mm 0 60 3 1 60", "x_mm 0 60 3 0 59", "y_mm 0 60 3 0 60"}) {
    refused("abbe-map-grid 1\nsense 1 1 1\ntool_mm 0 0 0\n" + std::string(axis) + "\n",
            ":4: not a grid");
  }
  std::string many = "abbe-map-grid 1\nsense 1 1 1\ntool_mm 0 0 0\n";
  for (const char axis : {'x', 'y', 'z'}) many += std::string(1, axis) + "_mm 0 60 1000 0 60\n";
  refused(many, ":6: too many points");
  refused(head, "the file may be cut off");
  refused(head + points, "no \"end\" behind the points");
  refused(head + points.substr(0, points.size() / 2), "cut off");
  refused(head + "1 2 3 4 5\n" + points + "end\n", ":7: not the 6 numbers");
  refused(head + "1 2 3 4 5 6 7\n" + points + "end\n", ":7: not the 6 numbers");
  refused(head + "1 2 3 4 5 inf\n" + points + "end\n", ":7: not the 6 numbers");
  abbe_grid_free(&grid_);
  char reason[ABBE_GRID_REASON];
  EXPECT_EQ(abbe_grid_read("/nowhere/at.all", &grid_, reason), 0);
  EXPECT_STREQ(reason, "/nowhere/at.all: cannot be read");
}

}  // namespace abbe_grid_test
}  // namespace abbe::control
