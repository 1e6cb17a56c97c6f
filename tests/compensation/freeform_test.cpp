// A freeform path on the virtual rig, corrected by the map that its own campaign gave: what is left
// is what the map states as its uncertainty, not more.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "compensation/nc_correction.h"
#include "tests/fusion/rig_campaign.h"
#include "tests/pull_statistics.h"
#include "tests/seeds.h"

namespace abbe::compensation {
namespace freeform_test {

using Eigen::Vector3d;

constexpr int kPoints = 200;
constexpr double kMost = 1.1;  // of the map's own uncertainty, rms along the path

// A closed curve through most of the volume.
std::vector<Vector3d> Path() {
  std::vector<Vector3d> path;
  for (int i = 0; i < kPoints; ++i) {
    const double t = 2 * std::numbers::pi * i / kPoints;
    path.emplace_back(0.030 + 0.026 * std::sin(2 * t), 0.030 + 0.026 * std::sin(3 * t + 0.5),
                      0.030 + 0.026 * std::cos(t));
  }
  return path;
}

// The path as an NC program, corrected, as the axes are then commanded.
std::vector<Vector3d> Commands(const Corrector& corrector, const std::vector<Vector3d>& path) {
  NcOptions options;
  options.limits.length = 1.0;  // a line for a line
  std::string program, text;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Vector3d mm = 1e3 * path[i];
    program +=
        fmt::format("{} X{:.6f} Y{:.6f} Z{:.6f}\n", i == 0 ? "G0" : "G1", mm.x(), mm.y(), mm.z());
  }
  NcSource source("", program);
  CorrectProgram(corrector, options, source, [&](std::string_view piece) { text += piece; });
  std::istringstream lines(text);
  std::vector<Vector3d> commands;
  for (std::string line; std::getline(lines, line);) {
    Vector3d mm;
    const char* const words = line.c_str() + line.find('X');
    EXPECT_EQ(std::sscanf(words, "X%lf Y%lf Z%lf", &mm.x(), &mm.y(), &mm.z()), 3) << line;
    commands.emplace_back(1e-3 * mm);
  }
  return commands;
}

// m^2 in space, means along the path.
struct Squares {
  double before = 0.0, left = 0.0, stated = 0.0;
};

Squares Judge(const fusion::Campaign& campaign, const map::ErrorMap& map,
              const std::vector<Vector3d>& path) {
  const Vector3d none = Vector3d::Zero();
  const std::vector<Vector3d> commands = Commands(Corrector(map, none), path);
  EXPECT_EQ(commands.size(), path.size());
  const auto made = [&](const Vector3d& axes) -> Vector3d {
    return campaign.TrueError(axes) + relm::NominalTip(campaign.machine.chain, axes);
  };
  Squares squares;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Vector3d wanted = relm::NominalTip(campaign.machine.chain, path[i]);
    squares.before += (made(path[i]) - wanted).squaredNorm() / kPoints;
    squares.left += (made(commands[i]) - wanted).squaredNorm() / kPoints;
    squares.stated += map.StandardUncertainty(path[i], none).squaredNorm() / kPoints;
  }
  return squares;
}

TEST(Freeform, CorrectedByAFusedMapIsAsTrueAsTheMapSays) {
  const settings::Document document = fusion::CampaignMachine();
  const std::vector<Vector3d> path = Path();
  Mean before, left, stated, ratio;
  const Seeds seeds = SeedsFromEnvironment();
  for (std::uint64_t seed = seeds.first; seed <= seeds.last; seed += seeds.step) {
    const fusion::Campaign campaign(document, seed);
    const std::vector<simulation::SimulatedRun> runs{campaign.Sweep('X'), campaign.Sweep('Y'),
                                                     campaign.Sweep('Z'), campaign.Linkage(),
                                                     campaign.Length('X')};
    const auto report = fusion::Fuse(campaign.machine, runs, {.choose_smoothness = false});
    const Squares squares = Judge(campaign, report.map, path);
    before.Add(squares.before);
    left.Add(squares.left);
    stated.Add(squares.stated);
    ratio.Add(squares.left / squares.stated);
  }
  fmt::print(
      "rms in space along the path: {:.2f} um as it is, {:.2f} um corrected, {:.2f} um "
      "stated; corrected / stated {:.3f}\n",
      1e6 * std::sqrt(before.mean()), 1e6 * std::sqrt(left.mean()), 1e6 * std::sqrt(stated.mean()),
      std::sqrt(ratio.mean()));
  // As far as so few machines tell it.
  EXPECT_LT(ratio.mean(), kMost * kMost + k99 * ratio.error());
  EXPECT_GT(before.mean(), kMost * kMost * stated.mean());  // without it the path would not pass
}

}  // namespace freeform_test
}  // namespace abbe::compensation
