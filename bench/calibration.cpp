// Seconds to calibrate the linkage: 588 poses on the 7 x 7 x 12 grid over 25 x 25 x 50 mm, the 24
// published parameters, everything but the noise known of the base; and to map the cube.
//
//   bench/calibration POSES.csv     writes the poses, then runs
//
// The file (angles q1 q2 q3 in rad, ball x y z in m, whitening W row by row, start to column 15) is
// what bench/calibration_scipy.py fits beside this program, from the same start to the same
// minimum.
#include <benchmark/benchmark.h>
#include <fmt/os.h>

#include <Eigen/Dense>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "fusion/mapping.h"
#include "random/counter_random.h"
#include "settings/document.h"
#include "simulation/linkage/linkage_problem.h"

namespace {

using namespace abbe;
using Eigen::Index;
using Eigen::Vector3d;

constexpr char kLinkage[] = R"(
[linkage]
form = "pivots"
link_1_mm = 120
link_2_mm = 120
[linkage.base]
position_mm = [-180, -30, -30]
)";

struct Case {
  relm::LinkageSettings settings =
      relm::ReadLinkageSettings(settings::Document::Parse(kLinkage, "linkage.toml").Root());
  simulation::LinkageSimulation simulation{
      machine::Chain::Parse("[w X Y b Z t]"), settings,
      relm::MakeLinkageModel(settings, relm::ErrorModel::kPublishedWithBearing)};
  simulation::LinkageRun run;

  // A linkage drawn from its tolerances, read with noise.
  Case() {
    Eigen::Matrix3Xd positions(3, 588);
    for (Index i = 0; i < 588; ++i) {
      const Index layer = i / 49;
      positions.col(i) = Vector3d(0.0175 + 0.025 / 6 * static_cast<double>(i % 7),
                                  0.0175 + 0.025 / 6 * static_cast<double>(i / 7 % 7),
                                  0.005 + 0.050 / 11 * static_cast<double>(layer));
    }
    run = simulation::RunAt(positions, settings);
    const random::CounterRandom random(1, 0);
    Eigen::VectorXd x = simulation.Values();
    std::uint64_t draw = 0;
    Index at = 0;
    for (const auto& block : simulation.Blocks()) {
      for (const auto& entry : block.entries) {
        if (at >= simulation::LinkageSimulation::kBase && !entry.held) {
          x[at] += entry.prior_sd * random.Normal(draw++);
        }
        ++at;
      }
    }
    run.readings.angles = simulation.Readings(run, x);
    for (double& angle : run.readings.angles.reshaped()) {
      angle += settings.noise.encoder * random.Normal(draw++);
    }
    for (double& place : run.reference.reshaped()) {
      place += settings.noise.reference * random.Normal(draw++);
    }
  }

  estimation::Problem Problem() const {
    auto problem =
        simulation::MakeLinkageProblem(simulation, {run}, {.loss = estimation::RobustLoss::None()});
    problem.Block(problem.Find("base")).Hold();
    problem.Block(problem.Find("base_turn")).Hold();
    return problem;
  }
};

const Case& TheCase() {
  static const Case instance;
  return instance;
}

// The poses, and after them, as a comment, the names, priors and estimates of the parameters.
void WritePoses(const std::string& path) {
  const Case& c = TheCase();
  auto out = fmt::output_file(path);
  const auto noise = c.simulation.GapNoise(c.run);
  const auto ball = c.simulation.Ball(c.run);
  for (Index pose = 0; pose < c.run.poses(); ++pose) {
    const Eigen::Matrix3d white = noise.middleCols<3>(3 * pose).inverse();
    std::string line;
    for (Index i = 0; i < 3; ++i) line += fmt::format("{},", c.run.readings.angles(i, pose));
    const Vector3d p_BT = ball.col(pose) - c.settings.X_MB.p;
    for (const double value : p_BT) line += fmt::format("{},", value);
    for (Index i = 0; i < 9; ++i) line += fmt::format("{},", white(i / 3, i % 3));
    line.back() = '\n';
    out.print("{}", line);
  }
  const auto result = simulation::SolveLinkage(c.Problem());
  for (const auto& block : result.blocks) {
    if (block.name.starts_with("base")) continue;
    for (std::size_t i = 0; i < block.entries.size(); ++i) {
      const auto& entry = block.entries[i];
      out.print("# {} {} {} {} {}\n", block.FullName(i), entry.nominal, entry.prior_sd, entry.value,
                entry.uncertainty);
    }
  }
}

void Calibrate588x24(benchmark::State& state) {
  const Case& c = TheCase();
  for (auto _ : state) {
    benchmark::DoNotOptimize(simulation::SolveLinkage(c.Problem()).chi_square);
  }
}

void MapTheCube(benchmark::State& state) {
  const Case& c = TheCase();
  const Eigen::VectorXd x =
      simulation::ParametersOf(simulation::SolveLinkage(c.Problem()).blocks, "");
  for (auto _ : state) {
    benchmark::DoNotOptimize(fusion::MapParameters(c.simulation, c.run, x).values.size());
  }
}

BENCHMARK(Calibrate588x24)->Unit(benchmark::kMillisecond);
BENCHMARK(MapTheCube)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (argc > 1) WritePoses(argv[1]);
  benchmark::RunSpecifiedBenchmarks();
  return EXIT_SUCCESS;
}
